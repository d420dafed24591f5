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
    return PassOrder(neighbours(count))


def _inward(options: PatternOptions) -> bool:
    assert isinstance(options, SurroundingOptions)
    return not options.inside_out


METHOD = OperationMethod(
    name="surrounding",
    title="Surrounding",
    explanation="Laps along the boundary from the edge inward, or from the middle outward.",
    options=SurroundingOptions,
    order=_order,
    inward=_inward,
)
