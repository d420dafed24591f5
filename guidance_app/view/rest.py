"""What is said of a plan's rest: passes done and left, and what the plan costs from its beginning. Pure."""

from dataclasses import dataclass

from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.model import Snapshot
from guidance_app.view.units import distance_text

__all__ = ["RestView", "rest_view"]


@dataclass(frozen=True, slots=True)
class RestView:
    """Names and values; no rows without a plan. ``numbers`` are those of all passes, ``left`` how many are not done."""

    rows: tuple[tuple[str, str], ...] = ()
    numbers: frozenset[int] = frozenset()
    left: int = 0


def rest_view(snapshot: Snapshot, units: Units, words: Words) -> RestView:
    """Of the plan that is driven."""
    plan = snapshot.plan
    if plan is None:
        return RestView()
    numbers = frozenset(each.number for each in (*plan.finished, *plan.segments))
    guidance = snapshot.guidance
    done = guidance.done if guidance is not None else frozenset(each.number for each in plan.finished)
    waiting = [str(each.number) for each in plan.segments if each.implement_down and each.number not in done]
    following = ", ".join(waiting[:5]) + (" …" if len(waiting) > 5 else "")
    costs = plan.costs
    rows = (
        (words("Passes done"), f"{len(numbers & done)} / {len(numbers)}"),
        (words("Passes left"), str(len(numbers - done))),
        (words("In this order"), following or "–"),
        (words("Worked, by plan"), distance_text(costs.work_m, units, words)),
        (words("Empty, by plan"), distance_text(costs.idle_m, units, words)),
        (words("Turns (tight)"), f"{costs.turns} ({costs.tight_turns})"),
    )
    return RestView(rows, numbers, len(numbers - done))
