"""A processed log against a reference log of the same drive."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

from guidance_app.decode.decoder import Decoder
from guidance_app.evaluation import Score, score, track_from_poses
from guidance_app.evaluation.real import track_from_fixes
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Chunk, Fix, Pose

__all__ = ["score_against", "score_members"]


def score_against(poses: Sequence[Pose], frame: FieldFrame, truth: Iterable[Chunk]) -> tuple[Score, Score]:
    """The scores of the poses, as they are and without the constant offset between the two receivers.

    Raises ``ValueError`` when the two have no common time.
    """
    decoder = Decoder()
    fixes: list[Fix] = []
    arrival = 0.0
    for chunk in truth:
        arrival = chunk.arrival
        fixes.extend(one for one in decoder.feed(chunk) if isinstance(one, Fix))
    fixes.extend(one for one in decoder.finish(arrival) if isinstance(one, Fix))
    reference = track_from_fixes(fixes, frame)
    estimate = track_from_poses(poses)
    return score(estimate, reference), score(estimate, reference, remove_offset=True)


def score_members(absolute: Score, relative: Score) -> dict[str, Any]:
    """The scores for JSON: metres, and degrees for the heading."""
    heading = relative.heading_rms
    return {
        "samples": absolute.samples,
        "rms_m": absolute.rms,
        "percentile_95_m": absolute.percentile_95,
        "worst_m": absolute.worst,
        "offset_east_m": relative.offset[0],
        "offset_north_m": relative.offset[1],
        "relative_rms_m": relative.rms,
        "relative_percentile_95_m": relative.percentile_95,
        "heading_rms_deg": None if heading is None else math.degrees(heading),
    }
