"""At the screen: a recorded drive leaves in every format, and time logs of other programs come in as recordings."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import viser
from support.drives import a_job, path_chunks, up_and_down
from support.field_files import RECTANGLE, kml_of, task_data, zipped
from support.recordings import driven_live
from support.setup_place import SetupPlace, setup_place

from guidance_app.exchange.drives import DRIVE_WRITERS
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import list_recordings

TIME_LOGS = "each of its time logs becomes a recording"
START = 1.7e9


@pytest.fixture
def office(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """The setup place on a data folder with one recorded drive."""
    driven_live(tmp_path, path_chunks(up_and_down(passes=1)), a_job())
    with setup_place(server, tmp_path) as one:
        yield one


def test_a_drive_leaves_in_every_format(office: SetupPlace) -> None:
    office.press(office.label("Look at"))
    for name, form in DRIVE_WRITERS.items():
        made = office.made(f"{name.upper()}: {form.words}")
        assert made.name.endswith(f"-{name}{form.ending}")
        assert len(made.data) > 1000


def test_a_time_log_of_another_program_becomes_a_recording(office: SetupPlace) -> None:
    instants = [
        Instant(START + n, (41.9301 + n / 111_100, -4.8699), 700.0, {"D": 4.0}, {0: int(n > 9)}) for n in range(40)
    ]
    head, body = written_log([LoggedValue(141, "DET-1")], instants)
    points = "".join(f'<PNT A="2" C="{latitude:.9f}" D="{longitude:.9f}"/>' for longitude, latitude in RECTANGLE)
    field = f'<PFD A="PFD1" C="Long acre"><PLN A="1"><LSG A="1">{points}</LSG></PLN></PFD>'
    tasks = field + '<TSK A="TSK1" B="Sowing" E="PFD1"><TLG A="TLG00001"/></TSK>'
    office.send(
        TIME_LOGS, "task.zip", zipped({"TASKDATA.XML": task_data(tasks), "TLG00001.XML": head, "TLG00001.BIN": body})
    )
    office.says("Long acre")
    newest = next(one for one in list_recordings(office.store.root) if "acre" in one.path.name)
    assert newest.summary is not None
    assert (newest.summary.field, newest.summary.ended, newest.summary.duration_s) == ("Long acre", True, 39.0)
    assert open_recording(newest.path).truncated is None


def test_an_upload_without_a_time_log_is_one_sentence(office: SetupPlace) -> None:
    office.send(TIME_LOGS, "field.zip", zipped({"TASKDATA.XML": task_data("")}))
    office.says("there is no time log in it")
    office.send(TIME_LOGS, "a.zip", zipped({"a.kml": kml_of("")}))
    office.says("no TASKDATA.XML in it")
