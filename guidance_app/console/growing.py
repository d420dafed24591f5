"""What grows all day, drawn at a cost that stays flat: worked ground as a ribbon of quads, the track as a line.

Pieces come in with few rows (a straight way has two). The *open* piece lies in an array of fixed size that each client
redraws by itself, because it changes with every fix. A sealed piece goes to the shared scene: first into a *staged*
node of at most 64 rows, from there into a *medium* node, which at 4,096 rows is left as it is and never sent again. So
a row is sent a bounded number of times, and ten hours fill a handful of nodes.

When time jumps back (a seek) everything is void: ``clear`` takes it all away.
"""

from abc import ABC, abstractmethod
from typing import cast

import numpy as np
import viser
from numpy.typing import NDArray

from guidance_app.model import FloatArray, Strip, Trail
from guidance_app.view.colours import Rgb
from guidance_app.view.polyline import Segments, thinned

__all__ = ["OPEN", "SEALED", "STAGED", "Growing", "Ribbon", "TrackLine", "add_track", "add_worked", "ribbon_faces"]

OPEN = 64
"""Rows of the open array."""

STAGED = 64
SEALED = 4096
TOLERANCE = 0.03
"""An open piece is drawn within 3 cm of where it is, or a little more where it would not fit into its array."""

Z_WORKED, Z_STEP, Z_STEPS = 0.02, 0.0006, 100
"""Each strip lies a little higher than the one before, so that a second working of the same ground shows through."""

Z_TRACK = 0.085
WORKED_OPACITY = 0.62

Node = viser.MeshHandle | viser.LineSegmentsHandle


class Growing(ABC):
    """Reads a trail, keeps the shared nodes up to date, and holds the open array for the clients.

    ``version`` changes with the open array. ``series`` changes when a medium node has begun: the clients' open node
    must then be made anew, so that it is drawn after it.
    """

    def __init__(self, scene: viser.SceneApi, name: str, colour: Rgb) -> None:
        self._scene = scene
        self._name = name
        self._colour = colour
        self._full: list[Node] = []
        self._medium: Node | None = None
        self._stage: Node | None = None
        self._medium_rows: list[FloatArray] = []
        self._staged_rows: list[FloatArray] = []
        self._seen = 0
        self._open: FloatArray | None = None
        self._open_piece: FloatArray | Strip | None = None
        self.version = 0
        self.series = 0

    @property
    def nodes(self) -> int:
        """How many nodes of the shared scene this fills."""
        return len(self._all())

    def _all(self) -> list[Node]:
        return [*self._full, *(node for node in (self._medium, self._stage) if node is not None)]

    def clear(self) -> None:
        """Takes away everything that was drawn."""
        for node in self._all():
            node.remove()
        self._full, self._medium, self._stage = [], None, None
        self._medium_rows, self._staged_rows, self._seen = [], [], 0
        self._open = self._open_piece = None
        self.version += 1
        self.series += 1

    def recolour(self, colour: Rgb) -> None:
        """Another time of day."""
        self._colour = colour
        for node in self._all():
            self._paint(node)

    def feed(self, trail: Trail | None) -> None:
        """Takes what is new of ``trail``; the shared nodes are sent once for all that came in together."""
        if trail is None:
            return
        sealed = trail.pieces[self._seen : trail.count]
        self._seen = trail.count
        if sealed:
            self._stage_all([self._rows(piece) for piece in sealed])
        if trail.open_piece is not self._open_piece:
            self._open_piece = trail.open_piece
            self._open = None if trail.open_piece is None else _fitting(self._columns(trail.open_piece))
            self.version += 1

    def _stage_all(self, pieces: list[FloatArray]) -> None:
        rolled = False
        for rows in pieces:
            self._staged_rows.append(rows)
            if _count(self._staged_rows) >= STAGED:
                self._medium_rows += self._staged_rows
                self._staged_rows = []
                rolled = True
                if _count(self._medium_rows) >= SEALED:
                    self._draw_medium()
                    self._finish_medium()
                    rolled = False
        if rolled:
            self._draw_medium()
        self._draw_stage()

    def _draw_medium(self) -> None:
        if self._medium is None:
            self._begin_series()
        self._medium = self._draw(f"{self._name}/{self.series}", np.concatenate(self._medium_rows))

    def _begin_series(self) -> None:
        """What lies above a new medium node must be made after it."""
        self.series += 1
        if self._stage is not None:
            self._stage.remove()
            self._stage = None

    def _finish_medium(self) -> None:
        if self._medium is not None:
            self._full.append(self._medium)
        self._medium, self._medium_rows = None, []

    def _draw_stage(self) -> None:
        if self._staged_rows:
            self._stage = self._draw(f"{self._name}/staged{self.series}", np.concatenate(self._staged_rows))
        elif self._stage is not None:
            self._stage.remove()
            self._stage = None

    @abstractmethod
    def _columns(self, piece: FloatArray | Strip) -> FloatArray:
        """The places of a piece, shape (N, 2) or (N, 4)."""

    @abstractmethod
    def _rows(self, piece: FloatArray | Strip) -> FloatArray:
        """A piece as it is kept: shape (N, columns of this kind)."""

    @abstractmethod
    def _draw(self, name: str, rows: FloatArray) -> Node:
        """Makes or replaces the shared node of these rows."""

    @abstractmethod
    def _paint(self, node: Node) -> None:
        """Gives the node its colour."""

    @abstractmethod
    def open_array(self) -> Segments:
        """The open piece in an array whose shape never changes."""


def _count(pieces: list[FloatArray]) -> int:
    return sum(len(piece) for piece in pieces)


def _fitting(columns: FloatArray) -> FloatArray:
    """At most ``OPEN`` rows of a piece, as near to it as they can be."""
    tolerance = TOLERANCE
    rows = thinned(columns, tolerance)
    while len(rows) > OPEN:
        tolerance *= 1.5
        rows = thinned(rows, tolerance)
    return rows


class Ribbon(Growing):
    """Worked ground. A row is the implement's left and right end and a height; neighbouring rows span a quad.

    Two strips are kept apart by rows without width, whose quads have no area.
    """

    def _columns(self, piece: FloatArray | Strip) -> FloatArray:
        strip = cast("Strip", piece)
        return np.hstack([strip.left, strip.right])

    def _rows(self, piece: FloatArray | Strip) -> FloatArray:
        strip = cast("Strip", piece)
        columns = self._columns(strip)
        first, last = columns[0, [0, 1, 0, 1]], columns[-1, [0, 1, 0, 1]]
        parted = np.vstack([first, columns, last])
        return np.column_stack([parted, np.full(len(parted), _height(strip))])

    def _draw(self, name: str, rows: FloatArray) -> viser.MeshHandle:
        return add_worked(self._scene, name, _ribbon_vertices(rows[:, :4], rows[:, 4]), self._colour)

    def _paint(self, node: Node) -> None:
        cast("viser.MeshHandle", node).color = self._colour

    def open_array(self) -> Segments:
        """Vertices of shape (2 OPEN, 3); those that are not needed stand on the last one."""
        if self._open is None or len(self._open) < 2:
            return np.zeros((2 * OPEN, 3), dtype=np.float32)
        height = _height(cast("Strip", self._open_piece))
        vertices = _ribbon_vertices(self._open, np.full(len(self._open), height))
        return np.concatenate([vertices, np.repeat(vertices[-1:], 2 * OPEN - len(vertices), axis=0)])


def _height(strip: Strip) -> float:
    return Z_WORKED + Z_STEP * (strip.index % Z_STEPS)


def _ribbon_vertices(columns: FloatArray, heights: FloatArray) -> NDArray[np.float32]:
    """Two vertices a row, shape (2 N, 3)."""
    vertices = np.empty((2 * len(columns), 3), dtype=np.float32)
    vertices[0::2, :2], vertices[1::2, :2] = columns[:, 0:2], columns[:, 2:4]
    vertices[:, 2] = np.repeat(heights, 2)
    return vertices


def ribbon_faces(rows: int) -> NDArray[np.uint32]:
    """The faces over rows of a left and a right vertex, seen from above; shape (2 rows - 2, 3), in the rows' order."""
    first = np.arange(rows - 1, dtype=np.uint32) * 2
    near, far = np.stack([first, first + 1, first + 2], 1), np.stack([first + 1, first + 3, first + 2], 1)
    return np.stack([near, far], axis=1).reshape(-1, 3)


def add_worked(scene: viser.SceneApi, name: str, vertices: NDArray[np.float32], colour: Rgb) -> viser.MeshHandle:
    """A node of worked ground over rows of two vertices."""
    return scene.add_mesh_simple(
        name,
        vertices,
        ribbon_faces(len(vertices) // 2),
        color=colour,
        opacity=WORKED_OPACITY,
        side="double",
        cast_shadow=False,
        receive_shadow=False,
    )


class TrackLine(Growing):
    """The way of the reference point. A row is one stroke: from (east, north) to (east, north)."""

    def _columns(self, piece: FloatArray | Strip) -> FloatArray:
        return cast("FloatArray", piece)

    def _rows(self, piece: FloatArray | Strip) -> FloatArray:
        places = self._columns(piece)
        return np.hstack([places[:-1], places[1:]])

    def _draw(self, name: str, rows: FloatArray) -> viser.LineSegmentsHandle:
        return add_track(self._scene, name, _strokes(rows), self._colour)

    def _paint(self, node: Node) -> None:
        cast("viser.LineSegmentsHandle", node).colors = np.array(self._colour, dtype=np.uint8)

    def open_array(self) -> Segments:
        """Strokes of shape (OPEN, 2, 3); those that are not needed stand on the last place."""
        if self._open is None or len(self._open) < 2:
            return np.zeros((OPEN, 2, 3), dtype=np.float32)
        strokes = _strokes(self._rows(self._open))
        spare = np.tile(strokes[-1, 1], (OPEN - len(strokes), 2, 1))
        return np.concatenate([strokes, spare])


def _strokes(rows: FloatArray) -> Segments:
    strokes = np.full((len(rows), 2, 3), Z_TRACK, dtype=np.float32)
    strokes[..., :2] = rows.reshape(-1, 2, 2)
    return strokes


def add_track(scene: viser.SceneApi, name: str, strokes: Segments, colour: Rgb) -> viser.LineSegmentsHandle:
    """A node of track."""
    return scene.add_line_segments(name, strokes, colour, thickness=2.0, thickness_units="screen")
