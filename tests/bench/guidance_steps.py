"""What one step of tracker and coverage costs.

Run in ``tests``: ``python -m bench.guidance_steps``. Processor time, so that a busy machine does not count. The tracker
works along lines and plans and idles between them; the coverage works a field of 10 hours at 12 m.
"""

import math
import time
from collections.abc import Callable, Iterable

import numpy as np
from support.passes import a_plan, a_pose, a_segment, drive_plan, poses_along, round_trip, rounded_ring

from guidance_app.guidance.coverage import Coverage
from guidance_app.guidance.family import ParallelLines
from guidance_app.guidance.patterns.curve import curves_beside
from guidance_app.guidance.tracking import Tracker
from guidance_app.model import Pose, SegmentKind

SPACING = 4.0


def microseconds(what: str, steps: int, run: Callable[[], object]) -> None:
    """One line of the table."""
    start = time.process_time()
    run()
    print(f"{what:58s} {1e6 * (time.process_time() - start) / steps:6.1f} us a step")  # noqa: T201 - its output


def follow(tracker: Tracker, poses: Iterable[Pose], *, working: bool) -> None:
    for pose in poses:
        tracker.step(pose, (pose.east, pose.north), working)


def plans() -> None:
    for count in (3, 30, 300):
        plan = round_trip(count, length=150.0)
        drive_plan(Tracker(round_trip(3), SPACING), round_trip(3))
        tracker = Tracker(plan, SPACING)
        steps = sum(round(one.length / 0.2) for one in plan.segments)
        microseconds(f"plan of {count} passes, worked and turned", steps, lambda t=tracker, p=plan: drive_plan(t, p))
        middle = 0.5 * SPACING * count
        across = [a_pose(0.1 * i, middle, 0.2 * (i % 500), 0.5 * math.sin(i)) for i in range(20_000)]
        microseconds(
            f"plan of {count} passes, idle between them",
            len(across),
            lambda a=across, t=tracker: follow(t, a, working=False),
        )


def lines() -> None:
    poses = list(poses_along(np.array([[0.3, 0.0], [0.0, 4000.0]])))
    tracker = Tracker(ParallelLines((0.0, 0.0), (0.0, 100.0), SPACING), SPACING)
    microseconds("AB line", len(poses), lambda: follow(tracker, poses, working=True))
    for count in (100, 1_000, 10_000):
        north = np.arange(count) * (5_000.0 / count)
        curve = np.column_stack([60.0 * np.sin(north / 150.0), north])
        family = curves_beside(curve, SPACING)
        line = family.pass_numbered(3)
        assert line is not None
        inner = line.points[(line.points[:, 1] > 0) & (line.points[:, 1] < 4000)]
        along = list(poses_along(inner))
        for working in (True, False):
            what = f"curve of {count} points, {'working' if working else 'idle'}"
            fresh = Tracker(family, SPACING)
            microseconds(what, len(along), lambda f=fresh, a=along, w=working: follow(f, a, working=w))
    ring = rounded_ring(1000.0, 8.0)
    lap = a_plan([a_segment(SegmentKind.LAP, 1, ring, closed=True)], SPACING)
    around = list(poses_along(ring))
    microseconds("lap of 4 km", len(around), lambda: follow(Tracker(lap, SPACING), around, working=True))


def coverage(width: float, hours: float) -> None:
    one = Coverage(width)
    length, step = 600.0, 0.3
    t = 0.0
    for hour in range(round(hours)):
        start, count = time.process_time(), 0
        for k in range(18 * hour, 18 * (hour + 1)):
            for s in np.arange(0.0, length, step).tolist():
                north, heading = (s, 0.0) if k % 2 == 0 else (length - s, math.pi)
                one.step((0.98 * width * k, north, heading + 0.003 * math.sin(0.05 * s)), t, s < length - 1, k)
                t += 0.1
                count += 1
            t += 10.0
        used = 1e6 * (time.process_time() - start) / count
        print(f"coverage {width:g} m, hour {hour + 1}: {one.tiles} tiles {used:6.1f} us a step")  # noqa: T201 - its output


if __name__ == "__main__":
    plans()
    lines()
    for width in (3.0, 12.0, 36.0):
        coverage(width, 10 if width == 12.0 else 2)
