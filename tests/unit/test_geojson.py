"""GeoJSON: real parcels keep their area, rings come back to the millimetre, bad files are one sentence."""

import contextlib
import json
import math
from pathlib import Path
from typing import Any

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod, Transformer
from support.documents import field_named, rectangle, ring_of

from guidance_app.boundary import BoundaryError, frame_of
from guidance_app.documents import FieldDocument, GuidanceLineDocument, LineGeometry
from guidance_app.exchange import ExchangeError, ReadOptions, checked_fields, read_field, write_field
from guidance_app.exchange.files import files_in
from guidance_app.exchange.geojson import read, written
from guidance_app.store import StoreError, field_from_file
from guidance_app.store.migrations import encoded

MILLIMETRE = 1e-3
AREA_TOLERANCE = 1e-4
"""0.01 %."""

RING = [list(corner) for corner in ring_of(rectangle(200, 100))]
WRITTEN = written(field_named("F"))
POLYGON = {"type": "Polygon", "coordinates": [RING]}


def write(folder: Path, content: Any, name: str = "f.geojson") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
    return path


def feature(geometry: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features: Any, **more: Any) -> dict[str, Any]:
    return {"type": "FeatureCollection", "features": list(features), **more}


@pytest.mark.real_logs
def test_every_real_parcel_keeps_its_area_within_a_hundredth_of_a_percent(real_data: Path) -> None:
    """The oracle is the geodesic area on the ellipsoid, which knows no projection."""
    paths = sorted((real_data / "fields").glob("*.geojson"))
    assert len(paths) > 40
    geod = Geod(ellps="WGS84")
    for path in paths:
        (field,) = checked_fields(path)
        raw = json.loads(path.read_text())["features"][0]["geometry"]["coordinates"]
        geodesic = geod.geometry_area_perimeter(shapely.orient_polygons(shapely.Polygon(raw[0], raw[1:])))[0]
        assert field.area == pytest.approx(abs(geodesic), rel=AREA_TOLERANCE), path.name


@pytest.mark.real_logs
def test_every_real_parcel_comes_back_to_the_millimetre(real_data: Path, tmp_path: Path) -> None:
    for path in sorted((real_data / "fields").glob("*.geojson")):
        document = read_field(path)
        write_field(document, tmp_path / path.name)
        again = read_field(tmp_path / path.name)
        frame = frame_of(document.boundary)
        for ring, same in zip(document.boundary.coordinates, again.boundary.coordinates, strict=True):
            apart = frame.array_from_lonlat(ring) - frame.array_from_lonlat(same)
            assert abs(apart).max() < MILLIMETRE


def test_a_whole_field_comes_back_as_it_was(tmp_path: Path) -> None:
    line = GuidanceLineDocument(name="East edge", type="ab", geometry=LineGeometry(coordinates=RING[:2]))
    document = field_named("圃場 1", "wet in spring").model_copy(
        update={"lines": [line], "entrance": (-4.8699, 41.9301)}
    )
    document = FieldDocument.model_validate(document.model_dump())
    path = tmp_path / "x.geojson"
    write_field(document, path)
    assert read_field(path) == document


def test_bare_geometries_features_and_heights_are_read(tmp_path: Path) -> None:
    with_height = {"type": "Polygon", "coordinates": [[[*corner, 713.0] for corner in RING]]}
    for content in (POLYGON, feature(POLYGON), collection(feature(POLYGON)), feature(with_height)):
        assert len(read_field(write(tmp_path, content)).boundary.coordinates[0]) == 5
    assert read_field(write(tmp_path, "\ufeff".encode() + json.dumps(POLYGON).encode())).name == "f"


def test_names_come_from_the_properties_and_markup_stays_text(tmp_path: Path) -> None:
    assert read_field(write(tmp_path, feature(POLYGON, name="  Long \n acre\x07 "))).name == "Long acre"
    assert read_field(write(tmp_path, feature(POLYGON, NAME="<b>x</b>", id=7))).name == "<b>x</b>"
    assert read_field(write(tmp_path, feature(POLYGON, id=7))).name == "7"
    assert read_field(write(tmp_path, feature(POLYGON, name=" ", id=None))).name == "f"


def test_several_fields_are_several_and_one_is_chosen_by_name(tmp_path: Path) -> None:
    path = write(tmp_path, collection(feature(POLYGON, name="A"), feature(POLYGON, name="B"), feature(None)))
    assert [each.document.name for each in checked_fields(path)] == ["A", "B"]
    assert read_field(path, "B").name == "B"
    with pytest.raises(ExchangeError, match=r"2 fields are in it \(A, B\)"):
        read_field(path)
    with pytest.raises(ExchangeError, match="no field is called 'C'; there are A, B"):
        read_field(path, "C")


def test_the_parts_of_a_multipolygon_become_fields_with_a_remark(tmp_path: Path) -> None:
    small = [list(corner) for corner in ring_of(rectangle(30, 30, (500, 0)))]
    parts = {"type": "MultiPolygon", "coordinates": [[small], [RING]]}
    first, second = checked_fields(write(tmp_path, feature(parts, name="A")))
    assert (first.document.name, second.document.name) == ("A (1)", "A (2)")
    assert second.area == pytest.approx(20_000, rel=1e-6)
    assert "2 parts" in first.remarks[0]
    one = {"type": "MultiPolygon", "coordinates": [[RING]]}
    assert checked_fields(write(tmp_path, feature(one)))[0].remarks == ()


def test_lines_and_points_of_others_are_left_out_with_a_remark(tmp_path: Path) -> None:
    line = feature({"type": "LineString", "coordinates": RING[:2]})
    (field,) = checked_fields(write(tmp_path, collection(feature(POLYGON), line)))
    assert field.remarks == ("1 points and lines in the file are left out",)
    with pytest.raises(ExchangeError, match="no polygon in it, only LineString"):
        read_field(write(tmp_path, collection(line)))


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("urn:ogc:def:crs:OGC:1.3:CRS84", "OGC:CRS84"),
        ("EPSG:4326", "EPSG:4326"),
        ("urn:ogc:def:crs:EPSG::32630", "EPSG:32630"),
        ("EPSG:3857", "EPSG:3857"),
        ("EPSG:25830", "EPSG:25830"),
    ],
)
def test_an_old_crs_member_is_honoured(tmp_path: Path, name: str, code: str) -> None:
    transformer = Transformer.from_crs("EPSG:4326", code, always_xy=True)
    there = [list(transformer.transform(*corner)) for corner in RING]
    crs = {"type": "name", "properties": {"name": name}}
    content = collection(feature({"type": "Polygon", "coordinates": [there]}), crs=crs)
    document = read_field(write(tmp_path, content))
    frame = frame_of(document.boundary)
    wanted, read = frame.array_from_lonlat(RING), frame.array_from_lonlat(document.boundary.coordinates[0])
    assert max(min(math.dist(a, b) for b in read) for a in wanted) < MILLIMETRE


@pytest.mark.parametrize(
    ("crs", "sentence"),
    [
        ({"type": "name", "properties": {"name": "EPSG:999999"}}, "is not known"),
        ({"type": "name", "properties": {"name": "EPSG:4301"}}, "cannot be turned into WGS 84 within 1 m"),
        ({"type": "link", "properties": {"href": "http://x"}}, "does not name a coordinate system"),
        ("EPSG:4326", "does not name a coordinate system"),
    ],
)
def test_a_coordinate_system_that_cannot_be_trusted_is_refused(tmp_path: Path, crs: Any, sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence):
        read_field(write(tmp_path, collection(feature(POLYGON), crs=crs)))


def with_corner(corner: Any) -> dict[str, Any]:
    return {"type": "Polygon", "coordinates": [[*RING[:2], corner, *RING[3:]]]}


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is empty"),
        (b"\x00\x01\x02\xff", "is not JSON"),
        (b'{"type": "Polygon", "coordinates": [[[', "is not JSON"),
        (b"[" * 100_000, "too deeply|is not JSON"),
        (b"[1, 2]", "not a GeoJSON object"),
        ({"type": "Topology"}, "not GeoJSON with a polygon"),
        ({"type": "FeatureCollection"}, "no list of features"),
        (collection(), "no polygon"),
        ({"type": "Polygon"}, "no rings"),
        ({"type": "Polygon", "coordinates": []}, "no rings"),
        ({"type": "Polygon", "coordinates": [5]}, "no corners"),
        ({"type": "MultiPolygon", "coordinates": []}, "no coordinates"),
        (with_corner("x"), "not two numbers"),
        (with_corner([1]), "not two numbers"),
        (with_corner([True, 41]), "not two numbers"),
        (with_corner([None, 41]), "not two numbers"),
        (with_corner([10**400, 41]), "not a number"),
        (with_corner([41.93, 139.7]), "look swapped"),
        (with_corner([512000.0, 4640000.0]), "look like metres"),
        (b'{"type": "Polygon", "coordinates": [[[NaN, 1], [2, 2], [3, 1]]]}', "NaN where a number belongs"),
        (b'{"type": "Polygon", "coordinates": [[[Infinity, 1], [2, 2], [3, 1]]]}', "Infinity where a number"),
        (b'{"type": "Polygon", "coordinates": [[[1e999, 1], [2, 2], [3, 1]]]}', "not a number"),
    ],
)
def test_every_bad_file_is_one_sentence_with_its_name(tmp_path: Path, content: Any, sentence: str) -> None:
    path = write(tmp_path, content)
    with pytest.raises(ExchangeError, match=sentence) as caught:
        read_field(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_missing_files_folders_and_strange_endings_are_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ExchangeError, match="cannot be read: No such file"):
        read_field(tmp_path / "no.geojson")
    (tmp_path / "dir.geojson").mkdir()
    with pytest.raises(ExchangeError, match="it holds no file at all"):
        read_field(tmp_path / "dir.geojson")
    with pytest.raises(ExchangeError, match=r"fields are read from .*\.geojson"):
        read_field(write(tmp_path, POLYGON, "field.docx"))
    with pytest.raises(ExchangeError, match="fields are written as"):
        write_field(field_named("F"), tmp_path / "field.docx")
    with pytest.raises(ExchangeError, match="cannot be written"):
        write_field(field_named("F"), tmp_path / "no" / "field.geojson")


def test_a_file_of_200_megabytes_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "big.geojson"
    with path.open("wb") as file:
        file.truncate(200_000_000)
    with pytest.raises(ExchangeError, match="larger than 50 MB"):
        read_field(path)


@given(st.binary(max_size=60), st.integers(0, 10_000))
def test_damaged_bytes_give_drafts_or_a_boundary_error(noise: bytes, place: int) -> None:
    cut = place % len(WRITTEN)
    damaged = WRITTEN[:cut] + noise + WRITTEN[cut + len(noise) :]
    with contextlib.suppress(BoundaryError):
        assert read(files_in(damaged, "f.geojson"), ReadOptions())


def test_a_field_file_may_be_our_own_document_or_geojson(tmp_path: Path) -> None:
    document = field_named("Own")
    own = write(tmp_path, encoded(document), "field.json")
    assert field_from_file(own) == document
    assert field_from_file(write(tmp_path, feature(POLYGON, name="G"), "g.json")).name == "G"
    crossing = document.model_dump(mode="json")
    ring = crossing["boundary"]["coordinates"][0]
    ring[1], ring[2] = ring[2], ring[1]
    with pytest.raises(StoreError, match="crosses itself"):
        field_from_file(write(tmp_path, crossing, "crossing.json"))
    with pytest.raises(StoreError, match="newer version"):
        field_from_file(write(tmp_path, {**document.model_dump(mode="json"), "schema_version": 2}, "newer.json"))
    for name, content in (("no.json", None), ("t.json", b'{"kind": "tractor", "name": "T"}'), ("b.json", b"\x00")):
        path = tmp_path / name if content is None else write(tmp_path, content, name)
        with pytest.raises(StoreError, match=name):
            field_from_file(path)
