"""What is written comes back: by our own reader to the millimetre, and as the same ground by a reader of others."""

import csv
import io
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pyogrio
import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from isoxml.util.isoxml_io import isoxml_from_text
from support.documents import ring_of
from support.field_files import field_with_lines

from guidance_app.boundary import checked_boundary, frame_of
from guidance_app.documents import FieldDocument, Position
from guidance_app.exchange import WRITERS, read_fields, written_as

MILLIMETRE = 1e-3
ORIGINS = st.tuples(st.floats(-60, 65), st.floats(-179, 179))


@st.composite
def fields(draw: st.DrawFn) -> FieldDocument:
    """A star-shaped field with a square hole, anywhere on earth."""
    count = draw(st.integers(3, 12))
    radii = draw(st.lists(st.floats(60, 400), min_size=count, max_size=count))
    corners = [
        (radius * np.cos(2 * np.pi * n / count), radius * np.sin(2 * np.pi * n / count))
        for n, radius in enumerate(radii)
    ]
    origin = draw(ORIGINS)
    hole = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)]
    rings = [ring_of(corners, origin)] + ([ring_of(hole, origin)] if draw(st.booleans()) else [])
    name = draw(st.text(st.characters(codec="utf-8", categories=["L", "Nd"]), min_size=1, max_size=20))
    return FieldDocument(name=name, boundary=checked_boundary(rings).geometry)


def assert_same_rings(document: FieldDocument, rings: list[list[Position]]) -> None:
    """The same corners in the same order, wherever a ring begins."""
    frame = frame_of(document.boundary)
    assert len(rings) == len(document.boundary.coordinates)
    for ours, theirs in zip(document.boundary.coordinates, rings, strict=True):
        wanted, found = frame.array_from_lonlat(ours[:-1]), frame.array_from_lonlat(theirs[:-1])
        assert len(wanted) == len(found)
        start = int(np.argmin(np.hypot(*(found - wanted[0]).T)))
        turns = [np.roll(found, -start, axis=0), np.roll(found[::-1], start + 1, axis=0)]
        assert min(np.abs(turned - wanted).max() for turned in turns) < MILLIMETRE


@given(fields(), st.sampled_from(sorted(WRITERS)))
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
def test_every_format_gives_back_the_same_ring_and_name(document: FieldDocument, ending: str) -> None:
    (field,) = read_fields(written_as(ending, document), f"x{ending}")
    assert_same_rings(document, [list(ring) for ring in field.geometry.coordinates])
    assert field.name == document.name
    assert field.remarks == ()


@pytest.mark.parametrize("ending", sorted(WRITERS))
def test_guidance_lines_come_back_where_the_format_holds_them(ending: str) -> None:
    document = field_with_lines("圃場 1")
    (field,) = read_fields(written_as(ending, document), f"x{ending}")
    assert field.name == document.name
    assert list(field.lines) == document.lines


def test_every_kind_of_guidance_line_survives_isoxml() -> None:
    document = field_with_lines()
    kinds = ("ab", "a-plus", "curve", "pivot")
    lines = [line.model_copy(update={"type": kind}) for kind, line in zip(kinds, document.lines * 2, strict=True)]
    (field,) = read_fields(written_as(".xml", document.model_copy(update={"lines": lines})), "TASKDATA.XML")
    assert [line.type for line in field.lines] == list(kinds)
    frame = frame_of(document.boundary)
    wanted = np.diff(frame.array_from_lonlat(document.lines[1].geometry.coordinates)[[0, -1]], axis=0)[0]
    found = np.diff(frame.array_from_lonlat(field.lines[1].geometry.coordinates), axis=0)[0]
    across = (wanted[0] * found[1] - wanted[1] * found[0]) / np.hypot(*wanted)
    assert across == pytest.approx(0, abs=MILLIMETRE)


# --- readers of others -----------------------------------------------------------------------------------------------


def with_gdal(path: Path, layer: str | None = None) -> tuple[dict[str, object], list[shapely.Geometry], list[str]]:
    meta, _, geometry, values = pyogrio.raw.read(path, layer=layer)
    names = values[list(meta["fields"]).index("name" if "name" in meta["fields"] else "Name")]
    return meta, list(shapely.from_wkb(geometry)), list(names)


def test_gdal_reads_our_shapefile_and_finds_the_outer_ring_clockwise(tmp_path: Path) -> None:
    document = field_with_lines("Größe 圃場")
    path = tmp_path / "field.zip"
    path.write_bytes(written_as(".zip", document))
    meta, (polygon,), (name,) = with_gdal(path, "field")
    assert name == document.name
    assert meta["crs"] == "EPSG:4326"
    assert_same_rings(document, [list(ring.coords) for ring in (polygon.exterior, *polygon.interiors)])
    assert not polygon.exterior.is_ccw
    assert all(ring.is_ccw for ring in polygon.interiors)
    _, lines, names = with_gdal(path, "lines")
    assert names == ["South edge", "Round"]
    assert [len(line.coords) for line in lines] == [2, 4]


def test_gdal_reads_our_kml(tmp_path: Path) -> None:
    document = field_with_lines("A <b> & 圃場")
    path = tmp_path / "field.kml"
    path.write_bytes(written_as(".kml", document))
    _, geometries, names = with_gdal(path)
    polygon = shapely.force_2d(geometries[0])
    assert names[0] == document.name
    assert_same_rings(document, [list(ring.coords) for ring in (polygon.exterior, *polygon.interiors)])


def test_gdal_reads_our_geojson(tmp_path: Path) -> None:
    document = field_with_lines()
    path = tmp_path / "field.geojson"
    path.write_bytes(written_as(".geojson", document))
    _, geometries, names = with_gdal(path)
    assert names[0] == document.name
    assert_same_rings(document, [list(ring.coords) for ring in (geometries[0].exterior, *geometries[0].interiors)])


def test_another_isoxml_library_reads_our_task_data() -> None:
    document = field_with_lines("圃場 & <1>")
    text = written_as(".xml", document).decode()
    data = isoxml_from_text(text)
    (field,) = data.partfields
    assert field.designator == document.name
    (polygon,) = field.polygons
    rings = [[(float(point.east), float(point.north)) for point in line.points] for line in polygon.line_strings]
    assert_same_rings(document, rings)
    assert [int(line.type.value) for line in polygon.line_strings] == [1, 2]
    assert [group.guidance_patterns[0].designator for group in field.guidance_groups] == ["South edge", "Round"]
    assert ET.fromstring(text).get("VersionMajor") == "4"


def test_any_csv_reader_reads_our_list_of_corners() -> None:
    document = field_with_lines()
    rows = list(csv.DictReader(io.StringIO(written_as(".csv", document).decode())))
    ring = [
        (float(row["longitude_deg"]), float(row["latitude_deg"]))
        for row in rows
        if row["part"] == "boundary" and row["ring"] == "0"
    ]
    assert [tuple(corner) for corner in document.boundary.coordinates[0][:-1]] == ring


def test_control_characters_in_notes_do_not_break_a_file() -> None:
    document = field_with_lines().model_copy(update={"notes": "wet\x0b\x00 in spring\ufffe <&>"})
    (field,) = read_fields(written_as(".kml", document), "x.kml")
    assert field.document.notes == "wet   in spring  <&>"
    for ending in WRITERS:
        assert read_fields(written_as(ending, document), f"x{ending}")
