"""Real logs driven live and recorded: the replay is the drive to the bit, with every filter, also after a stop."""

from pathlib import Path

import pytest
from support.drives import a_job
from support.recordings import Heard, Script, assert_same, is_over, taken_again

from guidance_app.estimation.filters import FILTERS
from guidance_app.model import Command, LineHere, Nudge, SetLookAhead, SetWork, Snapshot
from guidance_app.runtime import LiveSession, recorded_session, resumed_session
from guidance_app.sources.file import load_log
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_list import resumable

pytestmark = pytest.mark.real_logs

LOGS = {
    "tractor": "nmea/tractor_9m/impl9m_TLG00001_4dec.nmea",
    "car": "nmea/car_rtk_with_truth/MTV.Local1.SPAN.20200206-181434.gga",
}
EPOCHS = 400
SCRIPT_ENDED = "the script has ended"
WISHES: dict[int, Command] = {60: SetWork(down=True), 90: LineHere(), 150: Nudge(-0.4), 220: SetLookAhead(2.2)}


def driven(session: LiveSession, source: Script, *, ended: bool) -> list[Snapshot]:
    source.session = session
    heard = Heard(session)
    session.start()
    heard.wait(lambda one: is_over(one) and one.link.reason == SCRIPT_ENDED)
    session.close(ended=ended)
    return heard.snapshots


@pytest.mark.parametrize("name", sorted(LOGS))
@pytest.mark.parametrize("filter_name", sorted(FILTERS))
def test_replay_equals_live_to_the_bit_also_after_a_stop(
    filter_name: str, name: str, real_data: Path, tmp_path: Path
) -> None:
    steps: list = list(load_log(real_data / LOGS[name]).chunks[:EPOCHS])
    for place, wish in sorted(WISHES.items(), reverse=True):
        steps.insert(place, wish)
    half = len(steps) // 2
    source = Script(steps[:half])
    job = a_job(field=False, filter_name=filter_name)
    heard = driven(recorded_session(tmp_path, job, source), source, ended=False)
    found = resumable(tmp_path)
    assert found is not None
    source = Script(steps[half:])
    heard += driven(resumed_session(found.path, source), source, ended=True)
    drive = open_recording(found.path)
    assert drive.filter_name == filter_name
    replayed = taken_again(drive)
    assert len(heard) > 4
    for snapshot in heard:
        assert_same(snapshot, replayed[snapshot.sequence])
    assert heard[-1].link.fixes > 0.9 * EPOCHS
    assert heard[-1].pose is not None or filter_name != "off"
