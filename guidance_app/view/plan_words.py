"""What a plan promises before it is driven: its costs in rows, and what the driver should know first. Pure."""

from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.model import Plan, SegmentKind
from guidance_app.view.units import area_text, distance_text

__all__ = ["plan_cost_rows"]


def plan_cost_rows(plan: Plan, units: Units, words: Words) -> list[tuple[str, str]]:
    """Passes and laps, the way worked and empty, turns, minutes, and what of the field is worked, twice, or not."""
    costs = plan.costs
    passes = sum(one.kind is SegmentKind.PASS for one in plan.segments)
    laps = len({one.number for one in plan.segments if one.kind is SegmentKind.LAP})
    tight = words(" ({count} tight)", count=costs.tight_turns) if costs.tight_turns else ""
    rows = [
        (words("passes"), str(passes)),
        (words("way worked"), distance_text(costs.work_m, units, words)),
        (words("way empty"), distance_text(costs.idle_m, units, words)),
        (words("turns"), f"{costs.turns}{tight}"),
        (words("time"), words("{n} min", n=words.number(costs.minutes))),
        (words("worked"), words("{percent} %", percent=words.number(100 * costs.worked_fraction, 1))),
        (words("worked twice"), words("{percent} %", percent=words.number(100 * costs.overlap_fraction, 1))),
        (words("missed"), area_text(costs.missed_m2, units, words)),
    ]
    if laps:
        rows.insert(1, (words("sides of laps"), str(laps)))
    return rows
