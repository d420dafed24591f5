"""Round trip: each pass beside the one before, to and fro (boustrophedon)."""

from guidance_app.guidance.orders import neighbours
from guidance_app.guidance.pattern import OperationMethod, PassOrder, PatternOptions

__all__ = ["METHOD", "RoundTripOptions"]


class RoundTripOptions(PatternOptions):
    """Round trip has nothing to choose."""


def _order(count: int, options: PatternOptions) -> PassOrder:
    assert isinstance(options, RoundTripOptions)
    return PassOrder(neighbours(count))


METHOD = OperationMethod(
    name="round-trip",
    title="Round trip",
    explanation="To and fro, each pass beside the one before: 1 2 3 4 5 6.",
    options=RoundTripOptions,
    order=_order,
)
