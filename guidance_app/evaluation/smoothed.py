"""The offline smoother on a recording: what review, ledger and maps use once a drive is over."""

from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.smoothing import smooth
from guidance_app.evaluation.tracks import Recording, Track, measurements, track_from_poses

__all__ = ["smooth_recording"]


def smooth_recording(recording: Recording, settings: FilterSettings | None = None) -> Track:
    """The poses of the whole recording, each from all of its epochs, before and after."""
    return track_from_poses(smooth(list(measurements(recording)), settings))
