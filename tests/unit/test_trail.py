"""What grows is cut into bounded pieces that never change once sealed and stay where it was driven."""

import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from guidance_app.guidance.trail import MOST_ROWS, StripTrail, TrackTrail
from guidance_app.model import FloatArray, Strip, Trail

THINNED = 0.03
MICROMETRE = 1e-6


def winding(count: int, seed: int) -> FloatArray:
    """Shape (count, 4): t, east, north, heading of a drive at 0.2 m an epoch."""
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.02, count))
    moves = 0.2 * np.column_stack([np.sin(heading), np.cos(heading)])
    return np.column_stack([0.1 * np.arange(count), np.cumsum(moves, axis=0), heading])


def pieces_of(trail: Trail) -> list[FloatArray]:
    return [np.asarray(piece) for piece in trail.pieces[: trail.count]]


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_the_track_stays_within_3_cm_of_what_was_driven(seed: int) -> None:
    driven = winding(2000, seed)
    trail = TrackTrail()
    for t, east, north, heading in driven.tolist():
        trail.step(t, east, north, heading)
    pieces = pieces_of(trail.trail)
    assert len(pieces) >= 3
    assert all(2 <= len(piece) <= MOST_ROWS and not piece.flags.writeable for piece in pieces)
    for before, after in itertools.pairwise(pieces):
        assert np.array_equal(before[-1], after[0])
    assert trail.trail.open_piece is not None
    whole = shapely.LineString(np.vstack([*pieces, trail.trail.open_piece]))
    # beside the thinning, a row may stand where the track bent by 2 degrees within 0.3 m
    assert shapely.hausdorff_distance(whole, shapely.LineString(driven[:, 1:3])) < THINNED + 0.05


def test_a_straight_drive_costs_two_points_a_piece() -> None:
    trail = TrackTrail()
    for i in range(5000):
        trail.step(0.1 * i, 0.0, 0.2 * i, 0.0)
    assert {len(piece) for piece in pieces_of(trail.trail)} == {2}


def test_sealed_pieces_never_change_and_later_ones_only_follow() -> None:
    trail = TrackTrail()
    seen: list[FloatArray] = []
    copies: list[FloatArray] = []
    for t, east, north, heading in winding(4000, 5).tolist():
        trail.step(t, east, north, heading)
        now = trail.trail
        for piece in now.pieces[len(seen) : now.count]:
            seen.append(np.asarray(piece))
            copies.append(np.asarray(piece).copy())
    assert len(seen) > 5
    assert all(np.array_equal(piece, copy) for piece, copy in zip(seen, copies, strict=True))


def test_an_open_piece_that_was_handed_out_stays_as_it_was() -> None:
    trail = TrackTrail()
    trail.step(0.0, 0.0, 0.0, 0.0)
    trail.step(0.1, 0.0, 0.2, 0.0)
    handed_out = trail.trail.open_piece
    assert isinstance(handed_out, np.ndarray)
    before = handed_out.copy()
    for i in range(2, 20):
        trail.step(0.1 * i, 0.0, 0.2 * i, 0.0)
    assert np.array_equal(handed_out, before)


def test_standing_still_adds_nothing() -> None:
    trail = TrackTrail()
    for i in range(1000):
        trail.step(0.1 * i, 5.0, 5.0, 1.0)
    open_piece = trail.trail.open_piece
    assert isinstance(open_piece, np.ndarray)
    assert len(open_piece) == 2
    assert trail.trail.count == 0


def test_a_jump_of_the_position_is_not_drawn() -> None:
    trail = TrackTrail()
    for i in range(100):
        trail.step(0.1 * i, 0.0 if i < 50 else 40.0, 0.2 * i, 0.0)
    drawn = [*pieces_of(trail.trail), np.asarray(trail.trail.open_piece)]
    assert len(drawn) == 2
    assert max(np.hypot(*np.diff(piece, axis=0).T).max() for piece in drawn) < 15.0


@pytest.mark.parametrize("bad", [(math.nan, 0.0), (0.0, math.inf), (1e9, 0.0)])
def test_what_is_no_place_is_left_out(bad: tuple[float, float]) -> None:
    trail = TrackTrail()
    trail.step(0.0, 0.0, 0.0, 0.0)
    trail.step(0.1, *bad, 0.0)
    trail.step(0.2, 0.0, 0.4, 0.0)
    assert np.array_equal(np.asarray(trail.trail.open_piece), [[0.0, 0.0], [0.0, 0.4]])


def test_a_fork_of_a_track_goes_its_own_way() -> None:
    driven = winding(3000, 8).tolist()
    trail = TrackTrail()
    for t, east, north, heading in driven[:1500]:
        trail.step(t, east, north, heading)
    fork = trail.fork()
    for t, east, north, heading in driven[1500:]:
        fork.step(t, east + 2.0, north, heading)
        trail.step(t, east, north, heading)
    straight_on = TrackTrail()
    for t, east, north, heading in driven:
        straight_on.step(t, east, north, heading)
    assert trail.trail.count == straight_on.trail.count
    assert all(
        np.array_equal(one, other)
        for one, other in zip(pieces_of(trail.trail), pieces_of(straight_on.trail), strict=True)
    )
    assert not np.array_equal(np.asarray(fork.trail.open_piece), np.asarray(trail.trail.open_piece))


# --- strips -----------------------------------------------------------------------------------------------------------


def strips(trail: Trail) -> list[Strip]:
    found = [piece for piece in trail.pieces[: trail.count] if isinstance(piece, Strip)]
    assert len(found) == trail.count
    return found


def test_a_strip_grows_under_one_index_until_it_is_sealed() -> None:
    trail = StripTrail()
    trail.begin(((-1.0, 0.0, 1.0, 0.0),), (0.0, 0.0, 0.0), 4)
    sizes: dict[int, int] = {}
    for i in range(1, 1200):
        north = 0.35 * i
        trail.add(((-1.0, north, 1.0, north),), (0.0, north, 0.0))
        strip = trail.trail.open_piece
        if isinstance(strip, Strip):
            assert not strip.sealed
            assert strip.pass_number == 4
            assert len(strip.left) == len(strip.right) >= sizes.get(strip.index, 2)
            sizes[strip.index] = len(strip.left)
    trail.close()
    sealed = strips(trail.trail)
    assert [strip.index for strip in sealed] == sorted(sizes)
    assert max(sizes.values()) <= MOST_ROWS
    assert all(strip.sealed and len(strip.left) == 2 for strip in sealed)
    assert sum(float(strip.left[-1, 1] - strip.left[0, 1]) for strip in sealed) == pytest.approx(0.35 * 1199)
    assert trail.trail.open_piece is None


def test_runs_beside_the_widest_appear_when_they_are_sealed() -> None:
    trail = StripTrail()

    def runs(north: float) -> tuple[tuple[float, float, float, float], ...]:
        return ((-6.0, north, -4.0, north), (-2.0, north, 6.0, north))

    trail.begin(runs(0.0), (0.0, 0.0, 0.0), 1)
    for i in range(1, 300):
        trail.add(runs(0.35 * i), (0.0, 0.35 * i, 0.0))
        strip = trail.trail.open_piece
        assert isinstance(strip, Strip)
        assert strip.left[0, 0] == -2.0
        beside = [one for one in strips(trail.trail) if one.left[0, 0] == -6.0]
        drawn = max((float(one.left[-1, 1]) for one in beside), default=0.0)
        assert drawn >= 0.35 * i - 3.0
    trail.close()
    found = strips(trail.trail)
    assert len({one.index for one in found}) == len(found)
    for east, width in ((-6.0, 2.0), (-2.0, 8.0)):
        mine = [one for one in found if one.left[0, 0] == east]
        area = sum(float(one.left[-1, 1] - one.left[0, 1]) * width for one in mine)
        assert area == pytest.approx(0.35 * 299 * width)


def test_a_fork_of_strips_goes_its_own_way() -> None:
    trail = StripTrail()
    trail.begin(((-1.0, 0.0, 1.0, 0.0),), (0.0, 0.0, 0.0), 1)
    fork = trail.fork()
    fork.add(((-1.0, 5.0, 1.0, 5.0),), (0.0, 5.0, 0.0))
    fork.close()
    assert trail.trail.count == 0
    assert fork.trail.count == 1
