"""What an operation method is to the planner: a name, its options as a document, and an order of passes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, ValidationError

from guidance_app.guidance.request import PlanError
from guidance_app.language import sentence

__all__ = ["OperationMethod", "PassOrder", "PatternOptions"]


class PatternOptions(BaseModel):
    """Options of one method, each with title and bounds. Unknown ones are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


@dataclass(frozen=True, slots=True)
class PassOrder:
    """Passes in driving order, from 0. ``one_way`` drives all in one direction, returning empty."""

    sequence: tuple[int, ...]
    one_way: bool = False


@dataclass(frozen=True, slots=True)
class OperationMethod:
    """One way to work a whole field. ``order`` takes the number of passes and the options' document.

    ``inward`` is there for a method that works the field in laps: whether they begin at the boundary.
    """

    name: str
    title: str
    explanation: str
    options: type[PatternOptions]
    order: Callable[[int, PatternOptions], PassOrder]
    inward: Callable[[PatternOptions], bool] | None = None

    def options_from(self, given: Mapping[str, float | int | str | bool]) -> PatternOptions:
        """The options' document with its bounds checked. Raises ``PlanError`` naming the option."""
        try:
            return self.options.model_validate(dict(given))
        except ValidationError as error:
            first = error.errors()[0]
            place = ".".join(str(part) for part in first["loc"]) or "options"
            msg = sentence("method {name}, option {place}: {reason}", name=self.name, place=place, reason=first["msg"])
            raise PlanError(msg) from error

    def laps_inward(self, options: PatternOptions) -> bool:
        """Whether laps begin at the boundary; only of a method that works in laps."""
        assert self.inward is not None, f"{self.name} does not work in laps"
        return self.inward(options)

    def pass_order(self, count: int, options: PatternOptions) -> PassOrder:
        """The order for ``count`` passes; a broken permutation is a defect of the method."""
        order = self.order(count, options)
        assert sorted(order.sequence) == list(range(count)), f"{self.name}: not a permutation of {count} passes"
        return order
