"""The plan panel: a table that grows, one press shows a plan, another stores it; the rest panel posts commands."""

from pathlib import Path

import pytest
import viser
from support.setup_place import SetupPlace, setup_place
from support.snapshots import SetSession, field_snapshot

from guidance_app.documents import Method, Operation
from guidance_app.guidance.preview import METHODS
from guidance_app.model import Command, ReplanRest, TakePass
from guidance_app.store import copy_sample

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
        place.until(lambda: place.newest("Stop") and place.newest("row 2"))
        place.press("Stop")
        place.press("Compare plans")
        place.until(lambda: place.newest("Stop"))
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
