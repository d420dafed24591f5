"""``export`` and ``convert`` on the command line: files whole or not at all, bad use in one sentence."""

from pathlib import Path

import pytest
from support.drives import a_field, path_chunks, up_and_down
from support.field_files import csv_of, in_system, shapefile_parts, task_data, zipped

from guidance_app.cli import main
from guidance_app.commands.convert import system_from_text
from guidance_app.exchange import read_field, write_field
from guidance_app.exchange.drives import DRIVE_WRITERS
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.exchange.time_log_drive import nmea_of, read_time_log
from guidance_app.geodesy import Datum, Projection

Said = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "drive.nmea"
    path.write_bytes(b"".join(chunk.data for chunk in path_chunks(up_and_down(passes=1))))
    return path


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fields") / "square.geojson"
    write_field(a_field(), path)
    return path


@pytest.mark.parametrize("name", DRIVE_WRITERS)
def test_a_log_is_exported_in_every_format(log: Path, field: Path, tmp_path: Path, capsys: Said, name: str) -> None:
    out = tmp_path / f"drive{DRIVE_WRITERS[name].ending}"
    given = ["export", str(log), "--field", str(field), "--width", "6", "--format", name, "--out", str(out)]
    assert main(given) == 0
    assert out.stat().st_size > 1000
    assert "ha of the field not worked" in capsys.readouterr().out


def test_an_export_under_the_wrong_name_or_of_nothing_is_refused(log: Path, tmp_path: Path, capsys: Said) -> None:
    out = tmp_path / "drive.txt"
    assert main(["export", str(log), "--format", "gpx", "--out", str(out)]) == 2
    assert "end its name in .gpx" in capsys.readouterr().err
    silent = tmp_path / "silent.nmea"
    silent.write_bytes(b"$GPGGA,080000.00,,,,,0,00,,,M,,M,,*7A\r\n$GPGSA,A,1,,,,,,,,,,,,,,,*1E\r\n")
    out = tmp_path / "drive.gpx"
    assert main(["export", str(silent), "--format", "gpx", "--out", str(out)]) == 2
    assert "no position fix" in capsys.readouterr().err
    assert not out.exists()


def test_convert_says_what_is_in_a_file_and_writes_it_in_another_format(
    field: Path, tmp_path: Path, capsys: Said
) -> None:
    assert main(["convert", str(field)]) == 0
    assert "Square: 1.44 ha, 0 guidance lines" in capsys.readouterr().out
    for ending in (".kml", ".zip", ".xml", ".csv", ".geojson"):
        out = tmp_path / f"square{ending}"
        assert main(["convert", str(field), "--out", str(out)]) == 0
        assert read_field(out).name == "Square"


def test_convert_asks_for_the_option_that_it_needs_and_takes_it(tmp_path: Path, capsys: Said) -> None:
    source = tmp_path / "corners.csv"
    source.write_bytes(csv_of([(f"{east:.3f}", f"{north:.3f}") for east, north in in_system(32630)]))
    assert main(["convert", str(source)]) == 2
    assert "say in which system" in (said := capsys.readouterr().err)
    assert "use --system" in said
    assert main(["convert", str(source), "--system", "utm 30"]) == 0
    assert "2.00 ha" in (said := capsys.readouterr().out)
    assert "assumed: the columns are taken as east" in said
    assert main(["convert", str(source), "--system", "utm 30", "--tokyo"]) == 2
    assert "from 51 to 55" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["convert", str(source), "--system", "gauss"])
    assert "no coordinate system" in capsys.readouterr().err
    degrees = tmp_path / "degrees.csv"
    degrees.write_bytes(b"38.5467,140.0262\n38.5477,140.0262\n38.5477,140.0272\n")
    assert main(["convert", str(degrees), "--tokyo"]) == 0
    assert "tokyo datum" in capsys.readouterr().out


def test_one_of_several_fields_is_chosen_by_name(tmp_path: Path, capsys: Said) -> None:
    source, out = tmp_path / "two.zip", tmp_path / "one.kml"
    rings = [[list(reversed(a_field().boundary.coordinates[0]))]] * 2
    system = {"fields.prj": b'GEOGCS["WGS 84",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137,298.257223563]],'
              b'PRIMEM["Greenwich",0],UNIT["Degree",0.0174532925199433]]'}  # fmt: skip
    source.write_bytes(zipped(shapefile_parts(rings, ["A", "B"]) | system))
    assert main(["convert", str(source), "--out", str(out)]) == 2
    assert "2 of 2 fields can be written at a time; choose with --name from A, B" in capsys.readouterr().err
    assert main(["convert", str(source), "--out", str(out), "--name", "B"]) == 0
    assert read_field(out).name == "B"


def test_a_time_log_becomes_a_recording_that_exports_and_an_nmea_log(tmp_path: Path, capsys: Said) -> None:
    instants = [Instant(1.777e9 + n, (47.5 + n * 2e-5, 8.5), 400.0, {"D": 4.0}, {0: int(n > 5)}) for n in range(30)]
    head, body = written_log([LoggedValue(141, "DET-1")], instants)
    task = '<TSK A="TSK1" B="Sowing"><TLG A="TLG00001"/></TSK>'
    source = tmp_path / "up.zip"
    source.write_bytes(zipped({"TASKDATA.XML": task_data(task), "TLG00001.XML": head, "TLG00001.BIN": body}))
    recording, nmea = tmp_path / "run.zip", tmp_path / "run.nmea"
    assert main(["convert", str(source), "--log", "TLG00001", "--out", str(recording)]) == 0
    assert "time log TLG00001 of 'Sowing', 30 positions" in capsys.readouterr().out
    assert main(["export", str(recording), "--format", "csv", "--out", str(tmp_path / "run.csv")]) == 0
    assert main(["convert", str(source), "--log", "TLG00001", "--out", str(nmea)]) == 0
    assert nmea.read_bytes() == nmea_of(read_time_log(source))
    assert main(["process", str(nmea), "--out", str(tmp_path / "table.csv")]) == 0
    assert main(["convert", str(source), "--log", "TLG00001", "--out", str(tmp_path / "x.txt")]) == 2
    assert "--out FILE.zip (a recording)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "projection", "zone", "south"),
    [
        ("degrees", Projection.GEOGRAPHIC, None, False),
        ("utm 32", Projection.UTM, 32, False),
        ("UTM33S", Projection.UTM, 33, True),
        ("plane 9", Projection.PLANE_RECTANGULAR, 9, False),
    ],
)
def test_systems_are_named_in_few_words(text: str, projection: Projection, zone: int | None, south: bool) -> None:
    system = system_from_text(text)
    assert (system.projection, system.zone, system.south, system.datum) == (projection, zone, south, Datum.WORLD)
