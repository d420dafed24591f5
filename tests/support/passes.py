"""Plans made by hand, and drives along lines, pose by pose."""

import math
from collections.abc import Iterator

import numpy as np

from guidance_app.guidance.tracking import Tracker
from guidance_app.model import FloatArray, Guidance, Plan, PlanCosts, Pose, Segment, SegmentKind

COSTS = PlanCosts(0.0, 0.0, 0, 0, 0.0, 1.0, 0.0, 0.0)
INTERVAL = 0.1
SPEED = 2.0


def a_pose(t: float, east: float, north: float, heading: float = 0.0, speed: float = SPEED) -> Pose:
    return Pose(t=t, arrival=t, east=east, north=north, heading=heading, speed=speed, reverse=speed < 0)


def a_segment(kind: SegmentKind, number: int, points: FloatArray, *, closed: bool = False) -> Segment:
    down = kind in (SegmentKind.PASS, SegmentKind.LAP)
    ring = np.vstack([points, points[:1]]) if closed else points
    length = float(np.hypot(*np.diff(ring, axis=0).T).sum())
    return Segment(kind, number, points, implement_down=down, length=length, closed=closed)


def half_circle(start: tuple[float, float], end: tuple[float, float], *, clockwise: bool) -> FloatArray:
    """From start to end around their middle, shape (24, 2)."""
    middle = 0.5 * np.add(start, end)
    arm = np.subtract(start, middle)
    angles = np.linspace(0.0, -math.pi if clockwise else math.pi, 24)
    cos, sin = np.cos(angles), np.sin(angles)
    return middle + np.column_stack([cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]])


def a_plan(segments: list[Segment], spacing: float) -> Plan:
    return Plan("round-trip", 0.0, spacing, tuple(segments), (), COSTS)


def round_trip(count: int, length: float = 60.0, spacing: float = 4.0) -> Plan:
    """Passes north and south in turn from the west, half circles between."""
    segments = []
    for i in range(count):
        line = np.array([[i * spacing, 0.0], [i * spacing, length]])
        line = line if i % 2 == 0 else line[::-1]
        if segments:
            start, end = tuple(segments[-1].points[-1]), tuple(line[0])
            turn = half_circle(start, end, clockwise=i % 2 == 1)
            segments.append(a_segment(SegmentKind.TURN, i + 1, turn))
        segments.append(a_segment(SegmentKind.PASS, i + 1, line))
    return a_plan(segments, spacing)


def rounded_ring(side: float, radius: float, centre: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    """A square with round corners, clockwise from the middle of its west side, points 1 m apart or nearer."""
    straight = 0.5 * side - radius
    steps = np.arange(-straight, straight, 1.0)
    one_side = np.column_stack([np.full(len(steps), -0.5 * side), steps])
    angles = np.linspace(math.pi, 0.5 * math.pi, 24)
    corner = np.column_stack([np.cos(angles), np.sin(angles)]) * radius + (-straight, straight)
    quarter = np.vstack([one_side, corner])
    turns = [
        np.array([[1, 0], [0, 1]]),
        np.array([[0, -1], [1, 0]]),
        np.array([[-1, 0], [0, -1]]),
        np.array([[0, 1], [-1, 0]]),
    ]
    ring = np.vstack([quarter @ turn for turn in turns])
    begin = int(np.argmin(np.abs(ring[: len(steps), 1])))
    return np.roll(ring, -begin, axis=0) + centre


def poses_along(points: FloatArray, *, start: float = 0.0, speed: float = SPEED) -> Iterator[Pose]:
    """One every 0.1 s, heading along the line; the first at ``start`` seconds."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = round(float(along[-1]) / (speed * INTERVAL))
    driven = np.linspace(0.0, along[-1], count + 1)
    east, north = np.interp(driven, along, points[:, 0]), np.interp(driven, along, points[:, 1])
    for i in range(count):
        heading = math.atan2(east[i + 1] - east[i], north[i + 1] - north[i])
        yield a_pose(start + i * INTERVAL, float(east[i]), float(north[i]), heading, speed)


def drive(tracker: Tracker, poses: list[Pose], *, working: bool) -> list[Guidance]:
    """The guidance of every pose, the tractor's own point guided."""
    answers = [tracker.step(pose, (pose.east, pose.north), working) for pose in poses]
    assert all(answer is not None for answer in answers)
    return [answer for answer in answers if answer is not None]


def drive_plan(tracker: Tracker, plan: Plan, start: float = 0.0) -> list[tuple[Segment, Guidance]]:
    """Along the whole plan, the implement as planned."""
    driven: list[tuple[Segment, Guidance]] = []
    t = start
    for segment in plan.segments:
        points = np.vstack([segment.points, segment.points[:1]]) if segment.closed else segment.points
        poses = list(poses_along(points, start=t))
        t += INTERVAL * len(poses)
        driven += [(segment, one) for one in drive(tracker, poses, working=segment.implement_down)]
    return driven
