"""What the ground shows of the passes and of where the tractor is: states, strokes and colours, as plain arrays.

Heights keep flat things apart, in metres: meadow, soil, worked ground, lines, then what moves.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from guidance_app.angles import east_north
from guidance_app.estimation.prediction import pose_after
from guidance_app.model import FloatArray, Guidance, Pass, Pose, Snapshot, TurnGuide
from guidance_app.view.bar import TURN_NOW_S, TURN_SOON_S
from guidance_app.view.bar_states import STALE_AFTER_S
from guidance_app.view.camera import ViewMode
from guidance_app.view.colours import Palette, Rgb, vertex_source
from guidance_app.view.numerals import ADVANCE, HEIGHT, painted
from guidance_app.view.polyline import Segments, along, closed_ring, cut, dashed, point_at, segments, stretched, thinned

__all__ = [
    "MOST_NUMBERS",
    "Lines",
    "PassState",
    "Shown",
    "ellipse",
    "freshness_limit",
    "numbers",
    "pass_lines",
    "pass_state",
    "pass_strokes",
    "shown_pose",
    "turn_colour",
]

Z_LINES, Z_NUMBERS, Z_TARGET = 0.10, 0.11, 0.12

ENDLESS_REACH = 1000.0
"""An endless line is drawn this far beyond its points."""

CURVE_TOLERANCE = 0.03
"""A drawn curve leaves the true one by at most this."""

DASH_ON, DASH_OFF = 3.0, 3.0
MOST_NUMBERS = 48
SMALLEST_ELLIPSE = 0.10
"""An uncertainty whose longer half axis is below this is not drawn."""


class PassState(StrEnum):
    """How a pass is drawn."""

    TO_DO = "to do"
    NEXT = "next"
    DONE = "done"
    TARGET = "target"


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Strokes of shape (M, 2, 3) and the colour of each end, shape (M, 2, 3), as the renderer takes vertex colours."""

    points: Segments
    colours: NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Shown:
    """Where the tractor is drawn. ``stale``: no longer believed, drawn hollow; the heading may not be known yet."""

    east: float
    north: float
    heading: float
    heading_known: bool
    stale: bool


def freshness_limit(snapshot: Snapshot) -> float:
    """A position older than this many seconds is stale: 1 s, or two epochs where that is longer."""
    return max(STALE_AFTER_S, 2 * (snapshot.fix_interval or 0.0))


def shown_pose(snapshot: Snapshot, now: float) -> Shown | None:
    """The newest pose carried on to ``now``, at most to where it becomes stale; None without a pose."""
    pose = snapshot.pose
    if pose is None:
        return None
    age, limit = now - pose.arrival, freshness_limit(snapshot)
    at: Pose = pose_after(pose, min(max(age, 0.0), limit))
    return Shown(at.east, at.north, at.heading, pose.heading_known, age > limit)


def pass_state(number: int, guidance: Guidance | None) -> PassState:
    """What the pass of this number is at the moment."""
    if guidance is None:
        return PassState.TO_DO
    if number == guidance.target.number:
        return PassState.TARGET
    if number in guidance.done:
        return PassState.DONE
    return PassState.NEXT if number == guidance.next_number else PassState.TO_DO


def drawn_points(line: Pass) -> FloatArray:
    """The points to draw: closed where it is a lap, long where it is endless, thinned to 3 cm."""
    points = thinned(closed_ring(line.points) if line.closed else line.points, CURVE_TOLERANCE)
    return stretched(points, ENDLESS_REACH) if line.endless and not line.closed and len(points) > 1 else points


def pass_strokes(line: Pass, z: float = Z_TARGET) -> Segments:
    """The strokes of one pass."""
    return segments(cut(drawn_points(line)), z)


def pass_lines(passes: Sequence[Pass], guidance: Guidance | None, palette: Palette) -> Lines:
    """All passes in one: those done faint, the next dashed. The target lies below its own thick line."""
    colour_of = {
        PassState.TO_DO: palette.pass_to_do,
        PassState.NEXT: palette.pass_next,
        PassState.DONE: palette.pass_done,
        PassState.TARGET: palette.pass_to_do,
    }
    strokes: list[Segments] = []
    colours: list[Rgb] = []
    for line in passes:
        state = pass_state(line.number, guidance)
        points = drawn_points(line)
        if state is PassState.NEXT:
            piece = _lifted(dashed(points, DASH_ON, DASH_OFF), Z_LINES)
        else:
            piece = segments(cut(points), Z_LINES)
        strokes.append(piece)
        colours += [vertex_source(colour_of[state])] * len(piece)
    return _lines(strokes, colours)


def _lifted(flat: FloatArray, z: float) -> Segments:
    """Strokes of shape (M, 2, 3) from (M, 2, 2)."""
    raised = np.full((len(flat), 2, 3), z, dtype=np.float32)
    raised[..., :2] = flat
    return raised


def _lines(strokes: Sequence[Segments], colours: Sequence[Rgb]) -> Lines:
    if not colours:
        return Lines(np.empty((0, 2, 3), np.float32), np.empty((0, 2, 3), np.uint8))
    return Lines(np.concatenate(strokes), np.repeat(np.array(colours, np.uint8)[:, None, :], 2, axis=1))


# --- numbers -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NumberLayout:
    """How numbers lie in a view: where ahead they are looked for, how far apart they repeat, how large they are."""

    ahead: float
    every: float
    size: float
    stretch: float
    most: int
    reach: float = math.inf


def number_layout(mode: ViewMode, camera_distance: float, spacing: float) -> NumberLayout:
    """Sizes follow the camera's distance, so that a number looks equally large near and far.

    A driver's stand between their line and the next one, ``spacing`` away, as long as they can be read there.
    """
    d = camera_distance
    if mode is ViewMode.DRIVER:
        size = min(0.05 * d, max(0.19 * spacing, 0.025 * d))
        return NumberLayout(ahead=1.25 * d, every=0.8 * d, size=size, stretch=3.0, most=9, reach=1.3 * d)
    if mode is ViewMode.WHOLE_FIELD:
        return NumberLayout(ahead=0.0, every=1.0, size=0.0145 * d, stretch=1.0, most=MOST_NUMBERS)
    return NumberLayout(ahead=0.16 * d, every=0.32 * d, size=0.015 * d, stretch=1.0, most=17, reach=d)


def numbers(snapshot: Snapshot, shown: Shown | None, mode: ViewMode, layout: NumberLayout, palette: Palette) -> Lines:
    """The numbers of the passes that matter in this view; at most 48."""
    if mode is ViewMode.WHOLE_FIELD:
        guidance = snapshot.guidance
        target = None if guidance is None else guidance.target.number
        chosen = _apart(_numbers_at_ends(snapshot.passes, snapshot.field_rings, layout, target), layout, (0.0, 1.0))
    elif shown is not None:
        chosen = _numbers_on_lines(snapshot.passes, shown, mode, layout)
    else:
        chosen = []
    strokes: list[Segments] = []
    colours: list[Rgb] = []
    for line, place, up in chosen[: layout.most]:
        state = pass_state(line.number, snapshot.guidance)
        size = layout.size * (1.25 if state is PassState.TARGET else 1.0)
        piece = _lifted(painted(line.number, place, up, size=size, stretch=layout.stretch), Z_NUMBERS)
        strokes.append(piece)
        colours += [vertex_source(_number_colour(state, palette))] * len(piece)
    return _lines(strokes, colours)


def _number_colour(state: PassState, palette: Palette) -> Rgb:
    if state is PassState.TARGET:
        return palette.pass_target
    return palette.number_done if state is PassState.DONE else palette.number


_Placed = tuple[Pass, tuple[float, float], tuple[float, float]]


def _numbers_on_lines(passes: Sequence[Pass], shown: Shown, mode: ViewMode, layout: NumberLayout) -> list[_Placed]:
    """Beside each near line, at one of the fixed places along it that lies ahead; nearest line first."""
    forward = east_north(shown.heading)
    up = forward if mode.turns_with_tractor else (0.0, 1.0)
    wanted = shown.east + layout.ahead * forward[0], shown.north + layout.ahead * forward[1]
    placed: list[tuple[float, _Placed]] = []
    for line in passes:
        points = drawn_points(line)
        if len(points) < 2:
            continue
        metres, gap = along(points, *wanted)
        end = along(points, *points[-1])[0]
        snapped = min(max(round(metres / layout.every) * layout.every, 0.0), end)
        place, direction = point_at(points, snapped)
        same = direction[0] * up[0] + direction[1] * up[1]
        top = up if not mode.turns_with_tractor else (direction if same >= 0 else (-direction[0], -direction[1]))
        right = (top[1], -top[0])
        shift = layout.size * (0.9 + 0.75 * len(str(line.number)))
        beside = place[0] + right[0] * shift, place[1] + right[1] * shift
        placed.append((gap, (line, beside, top)))
    placed.sort(key=lambda item: item[0])
    return _apart([item for gap, item in placed if gap <= layout.reach], layout, forward)


def _numbers_at_ends(
    passes: Sequence[Pass], rings: Sequence[FloatArray], layout: NumberLayout, target: int | None
) -> list[_Placed]:
    """Outside the field below each pass, every second or third one where they would stand too close; target first."""
    straight = [line for line in passes if not line.lap and not line.endless and len(line.points) > 1]
    if not straight:
        return []
    gap = _nearest_gap(straight)
    skip = max(1, math.ceil(3.4 * layout.size / gap), math.ceil(len(straight) / layout.most))
    placed: list[_Placed] = []
    for line in [*(one for one in straight if one.number == target), *straight[::skip]]:
        first, second = (line.points[0], line.points[1])
        last, before = (line.points[-1], line.points[-2])
        end, inner = (first, second) if (first[1], first[0]) <= (last[1], last[0]) else (last, before)
        out = end - inner
        out = out / (np.hypot(*out) or 1.0)
        place = end + out * (_way_out(end, out, rings) + 1.6 * layout.size)
        placed.append((line, (float(place[0]), float(place[1])), (0.0, 1.0)))
    return placed


def _apart(placed: Sequence[_Placed], layout: NumberLayout, up: tuple[float, float]) -> list[_Placed]:
    """Those that can be read: a number that would stand over one before it is left out. ``up`` is that of the view."""
    kept: list[_Placed] = []
    boxes: list[tuple[float, float, float]] = []
    tall = layout.size * (HEIGHT * layout.stretch + 0.5)
    for one in placed:
        line, (east, north), _ = one
        across, ahead = east * up[1] - north * up[0], east * up[0] + north * up[1]
        half = layout.size * (ADVANCE * len(str(line.number)) + 0.25) / 2
        if all(abs(across - x) > half + wide or abs(ahead - y) > tall for x, y, wide in boxes):
            kept.append(one)
            boxes.append((across, ahead, half))
    return kept


def _way_out(end: FloatArray, out: FloatArray, rings: Sequence[FloatArray]) -> float:
    """Metres from the end of a pass to the field's boundary, in the direction it goes on."""
    if not rings:
        return 0.0
    start, step = rings[0][:-1], np.diff(rings[0], axis=0)
    seen = start - end
    across = out[0] * step[:, 1] - out[1] * step[:, 0]
    across = np.where(np.abs(across) < 1e-12, np.inf, across)
    ahead = (seen[:, 0] * step[:, 1] - seen[:, 1] * step[:, 0]) / across
    share = (seen[:, 0] * out[1] - seen[:, 1] * out[0]) / across
    hits = ahead[(ahead > 0) & (share >= 0) & (share <= 1)]
    return float(hits.max()) if len(hits) else 0.0


def _nearest_gap(passes: Sequence[Pass]) -> float:
    """The distance from one pass to the next, by their middles; at least 0.1 m."""
    if len(passes) < 2:
        return 10.0
    middles = np.array([line.points.mean(axis=0) for line in passes])
    return max(0.1, float(np.median(np.hypot(*np.diff(middles, axis=0).T))))


# --- what moves ----------------------------------------------------------------------------------------------------


def turn_colour(turn: TurnGuide, palette: Palette) -> Rgb:
    """Yellow and red as on the light bar, calm once it is being driven; red too where the turn does not fit."""
    if turn.driven and turn.fits:
        return palette.turn
    if not turn.fits or (turn.seconds is not None and turn.seconds < TURN_NOW_S):
        return palette.turn_now
    return palette.turn_soon if turn.seconds is not None and turn.seconds < TURN_SOON_S else palette.turn


def ellipse(covariance: tuple[float, float, float] | None, count: int = 40) -> FloatArray | None:
    """Two standard deviations around the origin, shape (count + 1, 2): east, north; None below 10 cm or unknown."""
    if covariance is None:
        return None
    var_east, cov, var_north = covariance
    values, axes = np.linalg.eigh(np.array([[var_east, cov], [cov, var_north]]))
    half = 2.0 * np.sqrt(np.maximum(values, 0.0))
    if half[1] < SMALLEST_ELLIPSE:
        return None
    angle = np.linspace(0.0, math.tau, count + 1)
    return np.asarray(np.column_stack([half[0] * np.cos(angle), half[1] * np.sin(angle)]) @ axes.T)
