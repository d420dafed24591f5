"""Surrounding: laps along the boundary, from the edge inward or from inside out, closing the middle."""

from pydantic import Field

from guidance_app.guidance.orders import neighbours
from guidance_app.guidance.pattern import OperationMethod, PassOrder, PatternOptions

__all__ = ["METHOD", "SurroundingOptions"]


class SurroundingOptions(PatternOptions):
    """Where the laps begin."""

    inside_out: bool = Field(default=False, title="From the middle to the edge")


def _order(count: int, options: PatternOptions) -> PassOrder:
    assert isinstance(options, SurroundingOptions)
    sequence = neighbours(count)
    return PassOrder(sequence[::-1] if options.inside_out else sequence)


METHOD = OperationMethod(
    name="surrounding",
    title="Surrounding",
    explanation="Laps along the boundary from the edge inward, or from the middle outward.",
    options=SurroundingOptions,
    order=_order,
    laps_only=True,
)
