"""The papers' protocols and tables, scenarios, metrics, tuning: how good the estimate is, in numbers.

For a researcher: :func:`estimate` runs any filter over arrays, :func:`score` compares the result with the truth.
"""

from guidance_app.evaluation.estimating import estimate
from guidance_app.evaluation.metrics import Score, score
from guidance_app.evaluation.tracks import Recording, Track, track_from_poses

__all__ = ["Recording", "Score", "Track", "estimate", "score", "track_from_poses"]
