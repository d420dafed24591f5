"""Transfer: passes are left out on the way across and filled back, so that turns are wider; or one way, back empty."""

from pydantic import Field

from guidance_app.guidance.orders import neighbours, skipping
from guidance_app.guidance.pattern import OperationMethod, PassOrder, PatternOptions

__all__ = ["METHOD", "TransferOptions"]


class TransferOptions(PatternOptions):
    """How many passes are left out, or whether all are driven in one direction."""

    one_way: bool = Field(default=False, title="All in one direction, back empty")
    skip: int = Field(1, title="Passes left out", ge=0, le=20, json_schema_extra={"when": ["one_way", False]})


def _order(count: int, options: PatternOptions) -> PassOrder:
    assert isinstance(options, TransferOptions)
    if options.one_way:
        return PassOrder(neighbours(count), one_way=True)
    return PassOrder(skipping(count, options.skip))


METHOD = OperationMethod(
    name="transfer",
    title="Transfer",
    explanation="Leaves passes out and fills them on the way back, for wide turns: 1 3 5 7 6 4 2.",
    options=TransferOptions,
    order=_order,
)
