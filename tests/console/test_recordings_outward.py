"""At the screen: a recorded drive leaves in every format, and time logs of other programs come in as recordings."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from support.drives import a_job, path_chunks, up_and_down
from support.field_files import RECTANGLE, kml_of, task_data, zipped
from support.recordings import driven_live
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.exchange.drives import DRIVE_WRITERS
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.runtime import SessionManager
from guidance_app.store import Store
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings

MOST_REDRAWS = 2000
SOON_S = 0.03
START = 1.7e9


class Office:
    """A console where nothing is driven, and one client."""

    def __init__(self, data: Path, house: House, screen: Screen, client: ViserClient) -> None:
        self.data, self.house, self.screen, self.client = data, house, screen, client

    def until(self, true: Callable[[], object]) -> None:
        for _ in range(MOST_REDRAWS):
            self.screen.tick()
            if self.client.soon(true, SOON_S):
                return
        told = [str(one) for one in self.client.messages if one["type"].startswith("Notification")]
        pytest.fail(f"it did not happen; told {told}; the panels say: {self.client.words()[-2000:]}")

    def says(self, pattern: str) -> None:
        self.until(lambda: re.search(pattern, self.client.words()))


@pytest.fixture
def office(tmp_path: Path) -> Iterator[Office]:
    """The setup place on a data folder with one recorded drive."""
    driven_live(tmp_path, path_chunks(up_and_down(passes=1)), a_job())
    manager = SessionManager()
    manager.start()
    house = House(manager, Store(tmp_path))
    with running_viser() as server:
        screen = Screen(server, house)
        screen.attach()
        with viser_client(server) as client:
            yield Office(tmp_path, house, screen, client)
    house.close()
    manager.close()


def test_a_drive_leaves_in_every_format(office: Office) -> None:
    office.says("Look at")
    labels = [str(one["props"].get("label")) for one in office.client.controls.values()]
    office.client.press(next(one for one in labels if one.startswith("Look at")))
    office.says("NMEA: ")
    for name, form in DRIVE_WRITERS.items():
        found = re.search(rf'/download/([\w-]+)"[^>]*>{name.upper()}: {form.words}', office.client.words())
        assert found is not None
        make = office.house.files.maker(found[1])
        assert make is not None
        made = make()
        assert made is not None
        assert made.name.endswith(f"-{name}{form.ending}")
        assert len(made.data) > 1000


def upload(office: Office, name: str, content: bytes) -> None:
    pattern = r'each of its time logs becomes a recording.*?data-upload="([\w-]+)" accept=".zip"'
    found = re.search(pattern, office.client.words(), re.DOTALL)
    assert found is not None
    take = office.house.files.taker(found[1])
    assert take is not None
    take(name, content)


def test_a_time_log_of_another_program_becomes_a_recording(office: Office) -> None:
    instants = [
        Instant(START + n, (41.9301 + n / 111_100, -4.8699), 700.0, {"D": 4.0}, {0: int(n > 9)}) for n in range(40)
    ]
    head, body = written_log([LoggedValue(141, "DET-1")], instants)
    points = "".join(f'<PNT A="2" C="{latitude:.9f}" D="{longitude:.9f}"/>' for longitude, latitude in RECTANGLE)
    field = f'<PFD A="PFD1" C="Long acre"><PLN A="1"><LSG A="1">{points}</LSG></PLN></PFD>'
    tasks = field + '<TSK A="TSK1" B="Sowing" E="PFD1"><TLG A="TLG00001"/></TSK>'
    office.says("each of its time logs becomes a recording")
    upload(office, "task.zip", zipped({"TASKDATA.XML": task_data(tasks), "TLG00001.XML": head, "TLG00001.BIN": body}))
    office.says("Long acre")
    newest = next(one for one in list_recordings(office.data) if "acre" in one.path.name)
    assert newest.summary is not None
    assert (newest.summary.field, newest.summary.ended, newest.summary.duration_s) == ("Long acre", True, 39.0)
    assert open_recording(newest.path).truncated is None


def test_an_upload_without_a_time_log_is_one_sentence(office: Office) -> None:
    office.says("each of its time logs becomes a recording")
    upload(office, "field.zip", zipped({"TASKDATA.XML": task_data("")}))
    office.until(lambda: "there is no time log in it" in str(office.client.messages))
    upload(office, "a.zip", zipped({"a.kml": kml_of("")}))
    office.until(lambda: "no TASKDATA.XML in it" in str(office.client.messages))
