"""AB line: endless straight passes beside the line from A to B."""

from guidance_app.guidance.family import GuidanceLineError, ParallelLines
from guidance_app.guidance.line_type import LineType
from guidance_app.language import sentence
from guidance_app.model import FloatArray

__all__ = ["LINE", "lines_beside"]


def lines_beside(points: FloatArray, spacing: float) -> ParallelLines:
    """Through the first and the last of the points."""
    if len(points) < 2:
        msg = sentence("an AB line needs its two points")
        raise GuidanceLineError(msg)
    (start_east, start_north), (end_east, end_north) = points[0].tolist(), points[-1].tolist()
    return ParallelLines((start_east, start_north), (end_east, end_north), spacing)


LINE = LineType(
    name="ab",
    title="AB line",
    explanation="Straight passes beside the line from A to B.",
    family=lines_beside,
)
