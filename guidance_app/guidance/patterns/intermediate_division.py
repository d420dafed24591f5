"""Intermediate division: the field in lands, each opened in its middle; or rounds without tight turns (racetrack)."""

from typing import Literal

from pydantic import Field

from guidance_app.documents import choice
from guidance_app.guidance.orders import lands, racetrack
from guidance_app.guidance.pattern import OperationMethod, PassOrder, PatternOptions
from guidance_app.language import message

__all__ = ["METHOD", "IntermediateDivisionOptions"]


class IntermediateDivisionOptions(PatternOptions):
    """The shape of the work within a land, and how wide lands are."""

    shape: Literal["lands", "racetrack"] = choice(
        "Within a land",
        "lands",
        {"lands": message("From its middle, left and right"), "racetrack": message("Racetrack")},
    )
    land: int = Field(6, title="Passes in a land", ge=1, le=200, json_schema_extra={"when": ["shape", "lands"]})
    half: int = Field(
        4, title="Passes in half a racetrack", ge=1, le=100, json_schema_extra={"when": ["shape", "racetrack"]}
    )


def _order(count: int, options: PatternOptions) -> PassOrder:
    assert isinstance(options, IntermediateDivisionOptions)
    if options.shape == "racetrack":
        return PassOrder(racetrack(count, options.half))
    return PassOrder(lands(count, options.land))


METHOD = OperationMethod(
    name="intermediate-division",
    title="Intermediate division",
    explanation="Divides the field into lands and opens each in its middle, right and left in turn: 3 4 2 5 1 6.",
    options=IntermediateDivisionOptions,
    order=_order,
)
