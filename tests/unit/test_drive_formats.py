"""A drive in every format, each read back by another reader than ours; and what the gathering of a drive gives."""

import csv
import io
import json
import math
import struct
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace
from pathlib import Path

import gpxpy
import numpy as np
import pyogrio
import pytest
import shapely
from isoxml.util.isoxml_io import isoxml_from_text
from support.drives import FRAME, a_job, path_chunks, up_and_down

from guidance_app.batch.exporting import drive_export, log_export, skipped_ground, worked_ground
from guidance_app.boundary import polygon_in
from guidance_app.decode.decoder import Decoder
from guidance_app.exchange.drives import DRIVE_WRITERS, DriveExport
from guidance_app.exchange.drives.csv_table import COLUMNS
from guidance_app.exchange.drives.record import LONGEST_GAP, DriveEpoch, time_text, tracks_of
from guidance_app.exchange.drives.shapefile_layers import NAMES
from guidance_app.exchange.time_log_drive import read_time_log
from guidance_app.model import Chunk, Fix, Strip
from guidance_app.sources.file import FileLog

MILLIMETRE_DEG = 1e-8
SEVEN_DECIMALS_DEG = 1e-7
AREA_TOLERANCE = 0.02
"""Of the worked area: coverage is counted in cells, the exported polygons are exact."""


@pytest.fixture(scope="module")
def drive() -> DriveExport:
    data = b"".join(chunk.data for chunk in path_chunks(up_and_down()))
    return log_export(FileLog("A <drive> & 圃場", data), a_job())


def place(epoch: DriveEpoch) -> tuple[float, float]:
    assert epoch.filtered is not None
    return epoch.filtered.longitude_deg, epoch.filtered.latitude_deg


def layer(content: bytes, folder: Path, name: str) -> tuple[dict[str, object], np.ndarray, dict[str, np.ndarray]]:
    path = folder / "drive.zip"
    path.write_bytes(content)
    meta, _, geometry, values = pyogrio.raw.read(path, layer=name)
    return meta, shapely.from_wkb(geometry), dict(zip(meta["fields"], values, strict=True))


def test_the_gathered_drive_holds_every_fix_and_where_it_was_filtered_and_predicted(drive: DriveExport) -> None:
    chunks = path_chunks(up_and_down())
    decoder = Decoder()
    fixes = [one for chunk in chunks for one in decoder.feed(chunk) if isinstance(one, Fix)]
    fixes += [one for one in decoder.finish(1e9) if isinstance(one, Fix)]
    assert [epoch.raw.latitude_deg for epoch in drive.epochs] == [fix.latitude_deg for fix in fixes]
    assert drive.sentences == b"".join(chunk.data for chunk in chunks)
    middle = drive.epochs[100]
    assert middle.predicted is not None
    ahead = math.dist(
        FRAME.east_north_from_degrees(*reversed(place(middle))),
        FRAME.east_north_from_degrees(middle.predicted.latitude_deg, middle.predicted.longitude_deg),
    )
    assert ahead == pytest.approx(2.5 * drive.look_ahead_s, abs=0.3)
    assert any(epoch.working for epoch in drive.epochs)
    assert any(epoch.cross_track is not None and epoch.pass_number is not None for epoch in drive.epochs)


def test_worked_and_skipped_ground_add_up_to_the_field(drive: DriveExport) -> None:
    assert drive.field is not None
    assert drive.skipped_area is not None
    field = polygon_in(FRAME, drive.field.boundary)
    rings = [[FRAME.array_from_lonlat(ring) for ring in polygon] for polygon in drive.worked]
    worked = shapely.union_all([shapely.Polygon(one[0], one[1:]) for one in rings])
    assert worked.area == pytest.approx(drive.worked_area, rel=1e-6)
    inside = worked.intersection(field).area
    assert inside + drive.skipped_area == pytest.approx(field.area, rel=AREA_TOLERANCE)
    assert drive.worked_area > 1000


def test_a_drive_without_a_field_has_no_skips() -> None:
    data = b"".join(chunk.data for chunk in path_chunks(up_and_down(passes=1)))
    alone = log_export(FileLog("log", data), a_job(field=False), "off")
    assert alone.skipped_area is None
    assert alone.skips == ()
    for form in DRIVE_WRITERS.values():
        assert form.write(alone)


def test_six_passes_whose_plain_union_goes_wrong_are_united_right(real_data: Path) -> None:
    lines = (real_data / "union_all_case.wkt").read_text().split("\n")
    passes = [shapely.from_wkt(line) for line in lines if line.startswith("POLYGON")]
    strips = []
    for number, one in enumerate(passes):
        corners = np.asarray(one.exterior.coords)[:4]
        strips.append(Strip(number, corners[[0, 3]], corners[[1, 2]], None, sealed=True))
    turned = [Strip(one.index, one.left[:, ::1], one.right, None, sealed=True) for one in strips]
    assert worked_ground(turned).area == pytest.approx(6256.14, abs=0.2)


def test_a_tight_turn_whose_steps_cross_counts_what_it_sweeps() -> None:
    left = np.array([[0.0, 0.0], [1.0, 1.0]])
    right = np.array([[1.0, 0.0], [0.0, 1.0]])
    assert worked_ground([Strip(0, left, right, None, sealed=False)]).area == pytest.approx(1.0)
    assert worked_ground([]).area == 0
    assert worked_ground([Strip(0, left[:1], right[:1], None, sealed=False)]).area == 0


def test_slivers_are_no_skips() -> None:
    field = shapely.box(0, 0, 100, 100)
    worked = shapely.union_all([shapely.box(0, 0, 49.97, 100), shapely.box(50.0, 0, 100, 90)])
    skips = skipped_ground(field, worked)
    assert skips.area == pytest.approx(500, rel=1e-3)


def test_a_recorded_drive_gives_the_same_as_its_log(drive: DriveExport, recorded_square: object) -> None:
    again = drive_export(recorded_square)  # type: ignore[arg-type]  # the fixture's own type
    assert [epoch.filtered for epoch in again.epochs] == [epoch.filtered for epoch in drive.epochs]
    assert again.worked_area == drive.worked_area


@pytest.fixture(scope="module")
def recorded_square(tmp_path_factory: pytest.TempPathFactory) -> object:
    """The same drive as a recording."""
    from guidance_app.recording import LineWriter, RecordingMeta  # noqa: PLC0415 - only this fixture makes one
    from guidance_app.store.recordings import EVENTS, SESSION, open_recording  # noqa: PLC0415 - as above

    folder = tmp_path_factory.mktemp("recording") / "square"
    folder.mkdir()
    job = a_job()
    meta = RecordingMeta(
        program="t", started_utc="2026-04-01T08:00:00Z", source="t", filter=job.receiver.filter, job=job
    )
    (folder / SESSION).write_text(meta.model_dump_json())
    data = b"".join(chunk.data for chunk in path_chunks(up_and_down()))
    log = FileLog("log", data)
    writer = LineWriter()
    events: list[Chunk] = [*log.chunks, Chunk(log.duration + 5, b"")]
    (folder / EVENTS).write_bytes(b"".join(writer.line(event) for event in events))
    return open_recording(folder)


# --- the formats -----------------------------------------------------------------------------------------------------


def test_the_table_has_a_row_an_epoch_and_raw_filtered_and_predicted(drive: DriveExport) -> None:
    rows = list(csv.DictReader(io.StringIO(DRIVE_WRITERS["csv"].write(drive).decode())))
    assert len(rows) == len(drive.epochs)
    assert tuple(rows[0]) == COLUMNS
    for row, epoch in ((rows[0], drive.epochs[0]), (rows[200], drive.epochs[200])):
        assert row["time_utc"] == time_text(epoch)
        assert float(row["raw_latitude_deg"]) == pytest.approx(epoch.raw.latitude_deg, abs=MILLIMETRE_DEG)
        assert float(row["filtered_longitude_deg"]) == pytest.approx(place(epoch)[0], abs=MILLIMETRE_DEG)
    assert rows[0]["time_utc"] == "2026-04-01T08:00:00.000Z"
    assert rows[200]["predicted_latitude_deg"]
    assert rows[200]["roll_deg"] == ""


def test_attitude_and_unknown_dates_are_told_in_degrees_and_times_of_day(drive: DriveExport) -> None:
    epoch = replace(drive.epochs[0], utc=None, t=3661.5, roll=math.radians(2), filtered=None, predicted=None)
    odd = replace(drive, epochs=(epoch,), worked=(), skips=(), field=None)
    (row,) = csv.DictReader(io.StringIO(DRIVE_WRITERS["csv"].write(odd).decode()))
    assert (row["time_utc"], row["roll_deg"], row["filtered_latitude_deg"]) == ("01:01:01.500", "2.0000", "")
    for form in DRIVE_WRITERS.values():
        assert form.write(odd)
    with zipfile.ZipFile(io.BytesIO(DRIVE_WRITERS["isoxml"].write(odd))) as archive:
        assert archive.namelist() == ["TASKDATA/TASKDATA.XML"]


def test_gpxpy_reads_both_tracks(drive: DriveExport) -> None:
    gpx = gpxpy.parse(DRIVE_WRITERS["gpx"].write(drive))
    assert [track.name for track in gpx.tracks] == ["A <drive> & 圃場, filtered", "A <drive> & 圃場, raw"]
    for track in gpx.tracks:
        assert sum(len(segment.points) for segment in track.segments) == len(drive.epochs)
    first = gpx.tracks[0].segments[0].points[0]
    assert (first.longitude, first.latitude) == pytest.approx(place(drive.epochs[0]), abs=MILLIMETRE_DEG)
    assert first.time is not None
    assert first.time.timestamp() == drive.epochs[0].utc


def test_a_silence_cuts_the_track(drive: DriveExport) -> None:
    late = tuple(replace(one, arrival=one.arrival + 2 * LONGEST_GAP) for one in drive.epochs[100:])
    silent = replace(drive, epochs=(*drive.epochs[:100], *late))
    assert [len(track) for track in tracks_of(silent)] == [100, len(drive.epochs) - 100]
    assert len(gpxpy.parse(DRIVE_WRITERS["gpx"].write(silent)).tracks[0].segments) == 2


def test_gdal_reads_the_kml(drive: DriveExport, tmp_path: Path) -> None:
    path = tmp_path / "drive.kml"
    path.write_bytes(DRIVE_WRITERS["kml"].write(drive))
    meta, _, geometry, values = pyogrio.raw.read(path)
    names = list(values[list(meta["fields"]).index("Name")])
    assert names == ["Square", "Worked area", "Skips", "Track"]
    shapes = [shapely.force_2d(one) for one in shapely.from_wkb(geometry)]
    assert ground_of(shapes[1]) == pytest.approx(drive.worked_area, rel=1e-5)
    assert shapely.get_num_coordinates(shapes[3]) == len(drive.epochs)


def ground_of(geometry: shapely.Geometry) -> float:
    return float(shapely.transform(geometry, FRAME.array_from_lonlat).area)


def test_geojson_holds_epochs_track_areas_and_field(drive: DriveExport) -> None:
    features = json.loads(DRIVE_WRITERS["geojson"].write(drive))["features"]
    kinds = [feature["properties"]["kind"] for feature in features]
    assert kinds[:4] == ["field", "worked", "skips", "track"]
    assert kinds.count("epoch") == len(drive.epochs)
    shapes = {kind: shapely.geometry.shape(one["geometry"]) for kind, one in zip(kinds, features, strict=True)}
    assert ground_of(shapes["worked"]) == pytest.approx(drive.worked_area, rel=1e-5)
    last = features[-1]
    assert last["geometry"]["coordinates"] == pytest.approx(place(drive.epochs[-1]))
    assert last["properties"]["working"] in {0, 1}


def test_gdal_reads_every_layer_of_the_shapefile(drive: DriveExport, tmp_path: Path) -> None:
    assert len(NAMES) == len(COLUMNS)
    assert all(len(name) <= 10 for name in NAMES)
    content = DRIVE_WRITERS["shapefile"].write(drive)
    meta, points, values = layer(content, tmp_path, "epochs")
    assert meta["crs"] == "EPSG:4326"
    assert len(points) == len(drive.epochs)
    assert points[0].coords[0] == pytest.approx(place(drive.epochs[0]), abs=MILLIMETRE_DEG)
    assert values["cross_m"][200] == pytest.approx(drive.epochs[200].cross_track, abs=1e-4)
    _, (worked,), areas = layer(content, tmp_path, "worked")
    assert areas["area_m2"][0] == pytest.approx(drive.worked_area, abs=0.1)
    assert ground_of(worked) == pytest.approx(drive.worked_area, rel=1e-5)
    assert ground_of(layer(content, tmp_path, "skips")[1][0]) == pytest.approx(drive.skipped_area, rel=1e-4)
    assert layer(content, tmp_path, "field")[2]["name"][0] == "Square"


def test_another_library_reads_the_task_data_and_the_log_is_laid_out_as_the_standard_says(drive: DriveExport) -> None:
    with zipfile.ZipFile(io.BytesIO(DRIVE_WRITERS["isoxml"].write(drive))) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    data = isoxml_from_text(files["TASKDATA/TASKDATA.XML"].decode())
    (task,) = data.tasks
    assert task.partfield_id_ref == data.partfields[0].id == "PFD1"
    assert task.designator == "A <drive> & 圃場"
    assert task.time_logs[0].filename == "TLG00001"
    totals = {value.process_data_ddi: value.process_data_value for value in task.times[0].data_log_values}
    assert totals[bytes.fromhex("0074")] == round(drive.worked_area)
    layout = [value.get("A") for value in ET.fromstring(files["TASKDATA/TLG00001.XML"]).findall("DLV")]
    assert layout == ["008D", "0043", "018D"]
    milliseconds, days, north, east = struct.unpack_from("<IHii", files["TASKDATA/TLG00001.BIN"])
    assert (milliseconds, days) == (8 * 3600 * 1000, 16892)
    assert (east / 1e7, north / 1e7) == pytest.approx(place(drive.epochs[0]), abs=SEVEN_DECIMALS_DEG)


def test_our_own_reader_gets_the_drive_back_from_the_task_data(drive: DriveExport) -> None:
    log = read_time_log(DRIVE_WRITERS["isoxml"].write(drive), name="up.zip")
    assert (log.field, log.task) == ("Square", "A <drive> & 圃場")
    assert len(log.rows) == len(drive.epochs)
    assert [row.working for row in log.rows] == [epoch.working for epoch in drive.epochs]
    assert [row.quality for row in log.rows] == [epoch.quality for epoch in drive.epochs]
    assert log.widest == drive.working_width
    assert log.rows[50].longitude_deg == pytest.approx(place(drive.epochs[50])[0], abs=SEVEN_DECIMALS_DEG)
