"""What is said of a drive afterwards: quality of the passes and the ledger, against drives whose answer is known."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from python_calamine import CalamineWorkbook
from support.drive_logs import HERTZ, passes_driven
from support.sessions import a_job

from guidance_app.batch.drive_log import gathered
from guidance_app.language import ENGLISH, words_for
from guidance_app.model import NO_PASS, CoverageTotals
from guidance_app.reports import SHEETS, LedgerEntry, ledger_entry, pass_qualities
from guidance_app.reports.ledger import Additions, columns
from guidance_app.reports.quality import histogram, overall, spacings
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_RECORDING, Store, copy_sample, load_job

SPACING = 6.0
MILLIMETRE = 1e-3


@pytest.fixture(scope="module")
def sample_entry(tmp_path_factory: pytest.TempPathFactory) -> LedgerEntry:
    """The embedded sample in the ledger."""
    data = copy_sample(tmp_path_factory.mktemp("sample"))
    job = load_job(Store(data), "Round trip")
    gathering = gathered(job, list(load_log(data / SAMPLE_RECORDING / "receiver.nmea").chunks))
    return ledger_entry("sample", job, gathering.log(), gathering.totals or CoverageTotals())


# --- quality ---------------------------------------------------------------------------------------------------------


def test_each_pass_has_its_own_error_with_its_sign() -> None:
    found = pass_qualities(passes_driven(0.10, -0.20, 0.0))
    assert [one.number for one in found] == [0, 1, 2]
    assert [one.mean for one in found] == pytest.approx([0.10, -0.20, 0.0], abs=MILLIMETRE)
    assert [one.rms for one in found] == pytest.approx([0.10, 0.20, 0.0], abs=MILLIMETRE)
    assert found[1].largest == pytest.approx(0.20, abs=MILLIMETRE)
    assert found[0].length == pytest.approx(195.0, abs=1.0)


def test_what_is_not_driven_on_a_pass_at_work_does_not_count() -> None:
    log = passes_driven(0.10, 0.30)
    lifted = replace(log, working=log.pass_number == 0)
    assert [one.number for one in pass_qualities(lifted)] == [0]
    nowhere = replace(log, pass_number=np.full(len(log), NO_PASS, np.int32))
    assert overall(nowhere) is None
    assert pass_qualities(nowhere) == ()


def test_the_spacing_is_what_lies_between_two_passes() -> None:
    apart = spacings(passes_driven(0.10, -0.10, 0.0), SPACING)
    assert [(one.first, one.second) for one in apart] == [(0, 1), (1, 2)]
    assert [one.mean for one in apart] == pytest.approx([5.8, 6.1], abs=MILLIMETRE)


def test_the_histogram_holds_every_fix_once() -> None:
    shares = histogram(passes_driven(0.011, -0.011, 2.0)).share
    assert shares.sum() == pytest.approx(1.0)
    assert shares[-1] == pytest.approx(1 / 3, abs=0.01)


# --- the ledger ------------------------------------------------------------------------------------------------------


def test_times_areas_and_stops_come_out_of_the_drive() -> None:
    log = passes_driven(0.0, 0.0)
    still = np.zeros(len(log), bool)
    still[100:400] = True
    entry = ledger_entry("one", a_job(), replace(log, standing=still), CoverageTotals(worked=2400.0, overlap=12.0))
    assert entry.duration_s == pytest.approx(len(log) / HERTZ, abs=1.0)
    assert [round(stop.seconds) for stop in entry.stops] == [60]
    assert entry.start is not None
    assert entry.rate_per_hour == pytest.approx(2400.0 / entry.working_s)


def test_the_samples_ledger_agrees_with_what_was_simulated(sample_entry: LedgerEntry) -> None:
    assert sample_entry.field == "Sample field"
    assert sample_entry.worked == pytest.approx(9_830, rel=0.01)
    assert sample_entry.duration_s == pytest.approx(788.6, abs=1.0)
    assert sample_entry.rms is not None
    assert 0.02 < sample_entry.rms < 0.15


def test_a_drive_without_any_fix_has_an_entry_too() -> None:
    nothing = passes_driven(0.0).part(slice(0, 0))
    entry = ledger_entry("none", a_job(), nothing, CoverageTotals())
    assert (entry.start, entry.worked, entry.rms, entry.stops) == (None, 0.0, None, ())
    for sheet in SHEETS.values():
        assert sheet([entry], "Ledger", ENGLISH)


def test_the_workbook_reads_back_with_its_numbers(sample_entry: LedgerEntry) -> None:
    content = SHEETS[".xlsx"]([sample_entry, sample_entry], "Ledger", ENGLISH)
    rows = CalamineWorkbook.from_filelike(io.BytesIO(content)).get_sheet_by_index(0).to_python()
    place = [name for name, _ in columns()].index("Area worked")
    assert rows[2][place] == "Area worked (ha)"
    assert rows[3][place] == pytest.approx(sample_entry.worked / 1e4)
    assert rows[5][place] == pytest.approx(2 * sample_entry.worked / 1e4)


def test_the_table_is_read_by_a_spreadsheet_of_its_language(sample_entry: LedgerEntry) -> None:
    named = replace(sample_entry, field="=HYPERLINK(1)", additions=Additions(notes="北の圃場; 2 l"))
    content = SHEETS[".csv"]([named], "Ledger", words_for("es")).decode("utf-8-sig")
    header, row = list(csv.reader(io.StringIO(content), delimiter=";"))
    assert len(header) == len(columns())
    assert row[1] == "'=HYPERLINK(1)"
    assert row[-1] == "北の圃場; 2 l"
    assert row[6] == "6,000"


def test_the_printed_sheet_says_names_of_any_script(sample_entry: LedgerEntry, tmp_path: Path) -> None:
    named = replace(sample_entry, field="圃場 <b>1</b> Поле & co")
    content = SHEETS[".pdf"]([named, sample_entry], "Ledger 2026", ENGLISH)
    assert content.startswith(b"%PDF-")
    assert content.count(b"/Type /Page\n") == 3
    assert b"HeiseiKakuGo" in content
    assert content == SHEETS[".pdf"]([named, sample_entry], "Ledger 2026", ENGLISH)
