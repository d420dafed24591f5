"""The plan panel: a table that grows, one press shows a plan, another stores it; the rest panel posts commands."""

import math
from pathlib import Path

import pytest
import viser
from support.setup_place import SetupPlace, setup_place
from support.snapshots import SetSession, field_snapshot

from guidance_app.documents import FieldDocument, Geometry, Method, Operation
from guidance_app.guidance.preview import METHODS
from guidance_app.model import Command, ReplanRest, TakePass
from guidance_app.store import Store, copy_sample

PRESSED = [("Plan the rest again from here", ReplanRest()), ("Take this pass", TakePass(1))]


def in_the_tab_of(place: SetupPlace, label: str, neighbour: str) -> bool:
    """Whether the container of one control lies beside the other control, not in another tab."""
    one, other = place.newest(label), place.newest(neighbour)
    assert one is not None
    assert other is not None
    holder = place.client.controls[one["container_uuid"]]
    return bool(holder["container_uuid"] == other["container_uuid"])


def rows_of(place: SetupPlace) -> list[int]:
    labels = [str(each["props"].get("label")) for each in place.client.controls.values()]
    return [int(label.removeprefix("row ")) for label in labels if label.startswith("row ")]


def test_plans_are_compared_shown_and_taken(server: viser.ViserServer, tmp_path: Path) -> None:
    with setup_place(server, copy_sample(tmp_path)) as place:
        before = place.store.list(Operation)[0].document
        place.press("Compare plans")
        place.until(lambda: place.newest("Compare plans") and "in laps" in place.client.words())
        place.says(r"\d+ plans\. The best: ")
        place.says("g-best")
        assert in_the_tab_of(place, "row 1", "Compare plans")
        last = max(rows_of(place))
        place.press(f"row {last}")
        place.sees("/w/sketch/worked")
        place.until(lambda: place.newest("Take this plan"))
        assert place.store.list(Operation)[0].document == before
        place.press(f"row {last}")
        place.says("is driven like this from its next start on")
        after = place.store.list(Operation)[0].document
        assert after.method is METHODS[-1] is Method.SURROUNDING
        assert after.model_copy(update={"method": before.method}) == before


def starry_field() -> FieldDocument:
    """Seconds of planning, in many rows: an edge of 40 sides, 700 m across."""
    ring = [
        (
            8.5 + (300 + 60 * (k % 2)) * math.cos(k * math.tau / 40) * 1.33e-5,
            47.5 + (300 + 60 * (k % 2)) * math.sin(k * math.tau / 40) * 9e-6,
        )
        for k in range(40)
    ]
    return FieldDocument(name="Star", boundary=Geometry(coordinates=[[*ring, ring[0]]]))


def test_a_long_comparison_shows_how_far_it_is_and_can_be_stopped(server: viser.ViserServer, tmp_path: Path) -> None:
    data = copy_sample(tmp_path)
    store = Store(data)
    store.save(starry_field())
    store.save(Operation(name="Spray", field="Star", tractor="Sample tractor", implement="Sample implement"))
    with setup_place(server, data) as place:
        place.until(lambda: (one := place.newest("Operation")) and "Star: Spray" in one["props"]["options"])
        place.fill("Operation", "Star: Spray")
        place.press("Compare plans")
        place.until(lambda: place.newest("Stop") and place.newest("row 1"))
        place.press("Stop")
        place.until(lambda: place.newest("Compare plans"))
        place.says(r"\d+ of 25 plans\. Best so far: ")


def test_without_an_operation_it_says_what_is_missing(server: viser.ViserServer, tmp_path: Path) -> None:
    with setup_place(server, tmp_path) as place:
        place.says("No operation is registered yet: register a field, machines and an operation first")
        assert place.newest("Compare plans") is None


@pytest.mark.parametrize(("pressed", "command"), PRESSED)
def test_the_rest_is_counted_and_commands_are_posted(server: viser.ViserServer, pressed: str, command: Command) -> None:
    session = SetSession(field_snapshot())
    with setup_place(server, None, session) as place:
        place.says("2 / 12")
        place.says("3, 4, 5, 6, 7 …")
        place.press(pressed)
        session.until_posted(command)
