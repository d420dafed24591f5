"""What grows all day: the same cost in the eighth hour as in the first, few nodes, and nothing lost on the way."""

import itertools
import math
from collections.abc import Iterator

import numpy as np
import pytest
import shapely
import viser
from support.snapshots import strip, trail
from support.viser_client import viser_client

from guidance_app.console.growing import OPEN, SEALED, STAGED, Growing, Ribbon, TrackLine, ribbon_faces
from guidance_app.guidance.trail import StripTrail, TrackTrail
from guidance_app.model import FloatArray

SPEED = 2.5
WIDTH = 6.0
PASS = 400.0
HOURS = 8
FED_EVERY = 20
MOST_NODES = 40
MOST_JOIN_BYTES = 4_000_000
MOST_BYTES_AN_HOUR = 4_000_000
"""The medium node grows from nothing to 4,096 rows and begins again; even where it is largest, about 1 kB/s."""

SQUARE_METRE = 1.0


class Day:
    """A tractor that works up and down with the unsteadiness of a hand, one position a second."""

    def __init__(self) -> None:
        self.strips, self.track = StripTrail(), TrackTrail()
        self._generator = np.random.default_rng(5)

    def seconds(self, count: int) -> Iterator[int]:
        """Drives on; yields once a second."""
        for t in range(count):
            driven = t * SPEED
            number, along = divmod(driven, PASS)
            east = number * WIDTH + 0.08 * math.sin(driven / 9.0) + self._generator.normal(0.0, 0.01)
            north = along if number % 2 == 0 else PASS - along
            heading = 0.0 if number % 2 == 0 else math.pi
            side = WIDTH / 2 if number % 2 == 0 else -WIDTH / 2
            run = (east - side, north, east + side, north)
            place = (east, north, heading)
            if along < SPEED:
                self.strips.begin((run,), place, int(number))
            else:
                self.strips.add((run,), place)
            self.track.step(float(t), east, north, heading)
            yield t


def test_eight_hours_fill_few_nodes_at_a_flat_cost(server: viser.ViserServer) -> None:
    day = Day()
    worked, track = (
        Ribbon(server.scene, "/w/worked", (60, 120, 140)),
        TrackLine(server.scene, "/w/track", (40, 80, 100)),
    )
    sent = [0] * HOURS
    with Counting(worked, track) as drawn:
        for t in day.seconds(HOURS * 3600):
            if t % FED_EVERY == 0:
                worked.feed(day.strips.trail)
                track.feed(day.track.trail)
                sent[t // 3600] += drawn.taken() + worked.open_array().nbytes + track.open_array().nbytes
    assert worked.nodes + track.nodes < MOST_NODES
    assert max(sent) < MOST_BYTES_AN_HOUR
    assert sent[-1] < max(sent)
    with viser_client(server) as late:
        assert late.bytes < MOST_JOIN_BYTES
        assert {name for name in late.nodes if name.startswith("/w/worked/")}


class Counting:
    """Counts the bytes of every shared node that is made or made anew."""

    def __init__(self, *growing: Growing) -> None:
        self._growing = growing
        self._bytes = 0

    def __enter__(self) -> "Counting":
        for one in self._growing:
            draw = one._draw

            def counted(name: str, rows: FloatArray, draw=draw) -> object:
                node = draw(name, rows)
                arrays = [getattr(node, part) for part in ("vertices", "faces", "points") if hasattr(node, part)]
                self._bytes += sum(array.nbytes for array in arrays)
                return node

            one._draw = counted
        return self

    def __exit__(self, *_: object) -> None:
        for one in self._growing:
            del one._draw

    def taken(self) -> int:
        """Bytes since it was asked last."""
        taken, self._bytes = self._bytes, 0
        return taken


def area(nodes: list[viser.MeshHandle]) -> float:
    """Square metres of all triangles."""
    total = 0.0
    for node in nodes:
        a, b, c = (node.vertices[node.faces[:, k], :2].astype(float) for k in range(3))
        (x1, y1), (x2, y2) = (b - a).T, (c - a).T
        total += float(np.abs(x1 * y2 - x2 * y1).sum()) / 2
    return total


def test_the_ribbon_shows_exactly_the_strips(server: viser.ViserServer) -> None:
    ribbon = Ribbon(server.scene, "/w/worked", (60, 120, 140))
    lines = [np.array([[WIDTH * k, 0.0], [WIDTH * k, 30.0], [WIDTH * k + 1, 90.0]]) for k in range(60)]
    pieces = [strip(k, line) for k, line in enumerate(lines)]
    for count in (1, 2, 30, 60):
        ribbon.feed(trail(pieces[:count]))
        drawn = area([node for node in ribbon._all() if isinstance(node, viser.MeshHandle)])
        meant = sum(
            shapely.Polygon([*piece.left, *piece.right[::-1]]).area for piece in itertools.islice(pieces, count)
        )
        assert drawn == pytest.approx(meant, abs=SQUARE_METRE)


def test_a_full_node_is_never_sent_again(server: viser.ViserServer) -> None:
    ribbon = Ribbon(server.scene, "/w/worked", (60, 120, 140))
    zigzag = np.column_stack([np.arange(200.0), np.tile([0.0, 1.0], 100)])
    pieces = [strip(k, np.add(zigzag, (0.0, 9.0 * k))) for k in range(60)]
    ribbon.feed(trail(pieces[:30]))
    full = ribbon._all()[0]
    size = len(full.vertices)
    ribbon.feed(trail(pieces))
    assert ribbon._all()[0] is full
    assert len(full.vertices) == size >= 2 * SEALED


def test_clearing_takes_everything_and_begins_anew(server: viser.ViserServer) -> None:
    track = TrackLine(server.scene, "/w/track", (40, 80, 100))
    way = np.array([[0.0, 0.0], [0.0, 50.0], [8.0, 90.0]])
    track.feed(trail([way] * 40, way))
    before = track.version
    track.clear()
    assert track.nodes == 0
    assert track.version > before
    assert not track.open_array().any()
    track.feed(trail([way]))
    assert track.nodes == 1


def test_the_open_arrays_keep_their_shape(server: viser.ViserServer) -> None:
    ribbon = Ribbon(server.scene, "/w/worked", (60, 120, 140))
    track = TrackLine(server.scene, "/w/track", (40, 80, 100))
    angle = np.linspace(0.0, 40.0, 256)
    for count in (1, 2, 9, 256):
        spiral = np.column_stack([np.cos(angle), np.sin(angle)])[:count] * (4.0 + angle[:count, None])
        if count > 1:
            ribbon.feed(trail([], strip(0, spiral, sealed=False)))
        track.feed(trail([], spiral))
        assert ribbon.open_array().shape == (2 * OPEN, 3)
        assert track.open_array().shape == (OPEN, 2, 3)
    end = spiral[-1]
    assert track.open_array()[-1, 1, :2] == pytest.approx(end, abs=1e-3)
    assert track.open_array()[0, 0, :2] == pytest.approx(spiral[0], abs=1e-3)


def test_faces_join_neighbouring_rows() -> None:
    assert ribbon_faces(3).tolist() == [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]


def test_small_pieces_wait_in_the_staged_node(server: viser.ViserServer) -> None:
    track = TrackLine(server.scene, "/w/track", (40, 80, 100))
    way = np.array([[0.0, 0.0], [0.0, 50.0]])
    track.feed(trail([way] * (STAGED - 1)))
    assert track.nodes == 1
    track.feed(trail([way] * STAGED))
    assert track.series == 1
    assert track.nodes == 1
    track.feed(trail([way] * (STAGED + 1)))
    assert track.nodes == 2
