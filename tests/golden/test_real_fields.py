"""Every real field in every format keeps its ground, and every real archive is read or refused for a clear reason."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import shapely
from pyproj import Geod
from support.field_files import csv_of, shapefile_parts, zipped

from guidance_app.exchange import WRITERS, ExchangeError, ImportedField, read_fields, written_as
from guidance_app.exchange.shapefile_format import WGS84_PRJ
from guidance_app.exchange.time_log_drive import nmea_of, read_time_log, time_log_names

pytestmark = pytest.mark.real_logs

AREA_TOLERANCE = 1e-4
"""0.01 %."""
ISOXML_FIELDS = 21


def geodesic_area(rings: list[list[tuple[float, float]]]) -> float:
    """On the ellipsoid, which knows no projection."""
    polygon = shapely.orient_polygons(shapely.Polygon(rings[0], rings[1:]))
    return abs(Geod(ellps="WGS84").geometry_area_perimeter(polygon)[0])


def test_every_real_parcel_keeps_its_area_through_every_format(real_data: Path) -> None:
    paths = sorted((real_data / "fields").glob("*.geojson"))
    assert len(paths) > 40
    for path in paths:
        rings = json.loads(path.read_text())["features"][0]["geometry"]["coordinates"]
        truth = geodesic_area(rings)
        (field,) = read_fields(path)
        assert field.area == pytest.approx(truth, rel=AREA_TOLERANCE), path.name
        for ending in WRITERS:
            (again,) = read_fields(written_as(ending, field.document), f"x{ending}")
            assert again.area == pytest.approx(truth, rel=AREA_TOLERANCE), f"{path.name} {ending}"
        parts = shapefile_parts([rings], ["x"]) | {"fields.prj": WGS84_PRJ.encode()}
        (shape,) = read_fields(zipped(parts), "x.zip")
        assert shape.area == pytest.approx(truth, rel=AREA_TOLERANCE), path.name
        if len(rings) == 1:
            (listed,) = read_fields(csv_of([("lon", "lat"), *(tuple(corner[:2]) for corner in rings[0])]), "x.csv")
            assert listed.area == pytest.approx(truth, rel=AREA_TOLERANCE), path.name


def archives(real_data: Path) -> list[Path]:
    return sorted(path.parent for path in (real_data / "isoxml").rglob("TASKDATA.XML"))


def test_every_field_of_every_isoxml_archive_keeps_its_area(real_data: Path) -> None:
    assert archives(real_data)
    for folder in archives(real_data):
        fields = {field.name: field for field in read_fields(folder)}
        elements = ET.parse(folder / "TASKDATA.XML").getroot().findall("PFD")
        assert len(elements) == len(fields) == ISOXML_FIELDS
        for element in elements:
            name = " ".join(element.get("C", "").split())
            rings = [
                [(float(point.get("D", "")), float(point.get("C", ""))) for point in line.findall("PNT")]
                for line in element.findall("PLN/LSG")
            ]
            assert fields[name].area == pytest.approx(geodesic_area(rings), rel=AREA_TOLERANCE)
            assert fields[name].remarks == ()


def test_every_receiver_log_is_a_boundary_or_refused_for_a_clear_reason(real_data: Path) -> None:
    """None of the logs was driven round a field, so that each must say why it bounds nothing."""
    logs = sorted(path for path in (real_data / "nmea").rglob("*") if path.suffix in {".log", ".nmea", ".gga"})
    assert len(logs) > 15
    for path in logs:
        found, refusal = read_or_refused(path)
        assert found or any(reason in refusal for reason in REASONS), refusal
        assert len(refusal) < 250
        for field in found:
            assert field.area == pytest.approx(geodesic_area(field.geometry.coordinates), rel=AREA_TOLERANCE)


def read_or_refused(path: Path) -> tuple[tuple[ImportedField, ...], str]:
    """The fields, or the sentence without the path."""
    try:
        return read_fields(path), ""
    except ExchangeError as error:
        return (), str(error).removeprefix(str(path))


REASONS = (
    "does not come back to where it began",
    "crosses itself",
    "no three positions",
    "too small",
    "km apart",
    "no position",
)


def test_every_real_time_log_has_the_positions_that_others_read_from_it(real_data: Path) -> None:
    """The receiver logs beside it were made from the same files by another program."""
    for folder in archives(real_data):
        names = time_log_names(folder)
        assert names
        for name in names:
            log = read_time_log(folder, name)
            assert len(log.rows) > 4000
            assert {row.working for row in log.rows} == {True, False}
            assert log.widest == 9.0
            other = real_data / "nmea" / folder.name / f"impl9m_{name}_7dec.nmea"
            if other.exists():
                theirs = [line.split(",")[1:6] for line in other.read_text().splitlines() if "GGA" in line]
                ours = [line.split(",")[1:6] for line in nmea_of(log).decode().splitlines() if "GGA" in line]
                assert ours == theirs
