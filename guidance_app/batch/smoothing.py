"""A log with the future known: its measurements gathered, smoothed, and given back one a fix.

The engine meets both ends as filters: one that only listens, one that already knows. So everything around the
estimate (frame, lever arm, guidance, coverage) is the same as in the drive.
"""

from collections.abc import Iterable

from guidance_app.batch.processing import processed
from guidance_app.documents import Job
from guidance_app.estimation.filter import Filter, FilterSettings, Start
from guidance_app.estimation.smoothing import smooth
from guidance_app.model import Event, Measurement, Pose

__all__ = ["smoothed_poses"]


class _Listener:
    """Keeps every measurement and says nothing."""

    def __init__(self) -> None:
        self.heard: list[Measurement] = []

    def step(self, z: Measurement) -> Pose | None:
        self.heard.append(z)
        return None

    def begin(self, start: Start) -> None:
        """Nothing to begin: what is heard is kept as it is."""

    def fork(self) -> "_Listener":
        other = _Listener()
        other.heard = list(self.heard)
        return other


class _Known:
    """Gives the pose that is known for each measurement, by its time and arrival; None where the smoother has none."""

    def __init__(self, poses: dict[tuple[float, float], Pose]) -> None:
        self._poses = poses

    def step(self, z: Measurement) -> Pose | None:
        return self._poses.get((z.t, z.arrival))

    def begin(self, start: Start) -> None:
        """The smoother has seen the start already."""

    def fork(self) -> "_Known":
        return self


def smoothed_poses(events: Iterable[Event], job: Job, settings: FilterSettings | None = None) -> Filter:
    """A filter that knows the smoothed pose of every epoch of a log or recording."""
    listener = _Listener()
    for _ in processed(events, job, estimator=listener):
        pass
    return _Known({(pose.t, pose.arrival): pose for pose in smooth(listener.heard, settings)})
