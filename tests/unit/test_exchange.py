"""Every format in, every format out: what is read, what is said about it, and what is refused with which sentence."""

import json
from pathlib import Path

import pytest
from support.documents import rectangle, ring_of
from support.field_files import (
    LATLON,
    ONE_MILLIMETRE_ALL_ROUND,
    RECTANGLE,
    UTM30,
    corners_text,
    csv_of,
    in_system,
    kml_of,
    one,
    shapefile_parts,
    task_data,
    zipped,
)

from guidance_app.exchange import (
    READERS,
    WRITERS,
    ExchangeError,
    QuestionError,
    ReadOptions,
    read_fields,
)
from guidance_app.exchange.shapefile_format import WGS84_PRJ

HOLE = ring_of(rectangle(20, 20, (50, 50)))


# --- shapefiles ------------------------------------------------------------------------------------------------------


def test_a_shapefile_is_read_from_an_archive_a_folder_and_its_parts(tmp_path: Path) -> None:
    parts = shapefile_parts([[RECTANGLE[::-1], HOLE]], ["Größe"]) | {
        "fields.prj": WGS84_PRJ.encode(),
        "fields.cpg": b"UTF-8",
    }
    for name, content in parts.items():
        (tmp_path / name.upper()).write_bytes(content)
    for field in (one(zipped(parts), "up.zip"), *read_fields(tmp_path), *read_fields(tmp_path / "FIELDS.SHP")):
        assert field.name == "Größe"
        assert field.area == pytest.approx(20_000 - 400, abs=ONE_MILLIMETRE_ALL_ROUND)
        assert field.remarks == ()


def test_a_missing_prj_is_a_question() -> None:
    metres = in_system(32630)
    archive = zipped(shapefile_parts([[[*metres, metres[0]]]], ["A"]))
    with pytest.raises(QuestionError, match=r"the \.prj file is missing") as caught:
        read_fields(archive, "up.zip")
    assert caught.value.option == "system"
    field = one(archive, "up.zip", ReadOptions(system=UTM30))
    assert field.area == pytest.approx(20_000, abs=ONE_MILLIMETRE_ALL_ROUND)
    with pytest.raises(ExchangeError, match=r"its \.prj cannot be understood"):
        read_fields(zipped(shapefile_parts([[RECTANGLE]], ["A"]) | {"fields.prj": b"nonsense"}), "up.zip")
    datum = WGS84_PRJ.replace("WGS_1984", "North_American_1983", 2).encode()
    with pytest.raises(QuestionError, match="only within 4 m"):
        read_fields(zipped(shapefile_parts([[RECTANGLE]], ["A"]) | {"fields.prj": datum}), "up.zip")


def test_japanese_names_are_read_as_cp932_where_the_file_lies_in_japan() -> None:
    ring = [(longitude + 145, latitude - 3) for longitude, latitude in RECTANGLE]
    parts = shapefile_parts([[ring]], ["北の圃場"], "cp932") | {"fields.prj": WGS84_PRJ.encode()}
    field = one(zipped(parts), "up.zip")
    assert field.name == "北の圃場"
    assert field.assumptions == ("the names are taken as cp932, as the file does not say it",)
    assert one(zipped(parts | {"fields.cpg": b"932"}), "up.zip").assumptions == ()
    told = shapefile_parts([[RECTANGLE]], ["北の圃場"], "cp932") | {"fields.prj": WGS84_PRJ.encode()}
    assert one(zipped(told), "up.zip", ReadOptions(encoding="cp932")).name == "北の圃場"
    with pytest.raises(QuestionError, match="say which encoding"):
        read_fields(zipped(told), "up.zip", ReadOptions(encoding="utf-8"))
    with pytest.raises(ExchangeError, match="'klingon' of its names is not known"):
        read_fields(zipped(told), "up.zip", ReadOptions(encoding="klingon"))


def test_multipolygons_and_wrong_orientations_are_sorted_by_place() -> None:
    far = ring_of(rectangle(60, 60, (400, 0)))
    shape = [HOLE, RECTANGLE, far]
    first, second = read_fields(zipped(shapefile_parts([shape], ["A"]) | {"fields.prj": WGS84_PRJ.encode()}), "up.zip")
    assert (round(first.area), round(second.area)) == (19_600, 3600)
    assert "2 parts" in first.warnings[0]


def test_damaged_and_strange_shapefiles_are_one_sentence(tmp_path: Path) -> None:
    parts = shapefile_parts([[RECTANGLE]], ["A"]) | {"fields.prj": WGS84_PRJ.encode()}
    with pytest.raises(ExchangeError, match=r"not a sound shapefile|shapes are empty"):
        read_fields(zipped(parts | {"fields.shp": parts["fields.shp"][:120]}), "up.zip")
    with pytest.raises(ExchangeError, match="points or lines, not polygons"):
        read_fields(zipped(parts | {"fields.shp": b"x" * 200}), "up.zip")
    with pytest.raises(ExchangeError, match="not a sound shapefile"):
        read_fields(zipped(parts | {"fields.shp": b"x" * 20}), "up.zip")
    with pytest.raises(ExchangeError, match=r"choose fields\.shp"):
        read_fields(parts["fields.dbf"], "fields.dbf")
    nameless = {name: content for name, content in parts.items() if not name.endswith("dbf")}
    assert one(zipped(nameless), "up.zip").assumptions == ("the .dbf file is missing, so the fields have no names",)


# --- KML, GPX --------------------------------------------------------------------------------------------------------

POLYGON = (
    f"<Polygon><outerBoundaryIs><LinearRing><coordinates>\n{corners_text(RECTANGLE)}\n</coordinates></LinearRing>"
    f"</outerBoundaryIs><innerBoundaryIs><LinearRing><coordinates>{corners_text(HOLE)}</coordinates></LinearRing>"
    "</innerBoundaryIs></Polygon>"
)


def test_kml_and_kmz_are_read_with_holes_and_parts() -> None:
    kml = kml_of(POLYGON)
    for field in (
        one(kml, "a.kml"),
        one(zipped({"doc.kml": kml, "files/icon.png": b"x"}), "a.kmz"),
        one(b"\n" + kml, "A.KML"),
    ):
        assert (field.name, round(field.area)) == ("Long acre", 19_600)
    far = corners_text(ring_of(rectangle(60, 60, (400, 0)))).replace(",", ", ", 1)
    ring = f"<LinearRing><coordinates>{far}</coordinates></LinearRing>"
    second = f"<Polygon><outerBoundaryIs>{ring}</outerBoundaryIs></Polygon>"
    both = read_fields(kml_of(f"<MultiGeometry>{POLYGON}{second}</MultiGeometry>"), "a.kml")
    assert [(each.name, round(each.area)) for each in both] == [("Long acre (1)", 19_600), ("Long acre (2)", 3600)]
    assert one(kml_of(POLYGON, name=""), "a.kml").name == "Farm"
    inside = zipped({"export/a.kmz": zipped({"doc.kml": kml})})
    assert one(inside, "up.zip").name == "Long acre"


def test_a_closed_path_is_a_boundary_where_there_is_no_polygon() -> None:
    path = f"<LineString><coordinates>{corners_text(RECTANGLE)}</coordinates></LineString>"
    field = one(kml_of(path), "a.kml")
    assert "closed path is taken as the boundary" in field.assumptions[0]
    both = kml_of(f"{POLYGON}</Placemark><Placemark><name>gate</name>{path}")
    assert one(both, "a.kml").warnings == ("1 points and lines in the file are left out",)


BOMB = '<!DOCTYPE kml [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (kml_of(POLYGON, name="&b;", before=BOMB), "declares a document type or entities"),
        (kml_of(POLYGON)[:-20], "not sound XML"),
        (b"<kml>" + b"<a>" * 300 + b"</a>" * 300 + b"</kml>", "nested too deeply"),
        (kml_of("<Point><coordinates>1,2</coordinates></Point>"), "no polygon in it, nor a closed path"),
        (kml_of("<Polygon></Polygon>"), "no outer ring"),
        (kml_of(POLYGON.replace("-4.8", "x")), "not two numbers"),
        (kml_of("<LinearRing><coordinates></coordinates></LinearRing>"), "has no corners"),
        (kml_of(POLYGON.replace("-4.870000000", "nan")), "not a number"),
    ],
)
def test_a_bad_kml_is_one_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence):
        read_fields(content, "a.kml")


def gpx_of(points: list[tuple[float, float]], kind: str = "trk") -> bytes:
    point = "trkpt" if kind == "trk" else "rtept"
    inner = "".join(f'<{point} lat="{latitude:.9f}" lon="{longitude:.9f}"/>' for longitude, latitude in points)
    body = f"<trk><name>Round</name><trkseg>{inner}</trkseg></trk>" if kind == "trk" else f"<rte>{inner}</rte>"
    return f'<?xml version="1.0"?><gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1">{body}</gpx>'.encode()


def driven(beyond: int = 0) -> list[tuple[float, float]]:
    """Round the rectangle in steps of a metre, open, driven on past its beginning."""
    corners = [(0, 0), (200, 0), (200, 100), (0, 100)]
    metres = []
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        steps = int(abs(bx - ax) + abs(by - ay))
        metres += [(ax + (bx - ax) * n / steps, ay + (by - ay) * n / steps) for n in range(steps)]
    metres += [(n, 0.4 - 0.05 * n) for n in range(beyond)]
    return ring_of(metres)[:-1]


def test_a_track_round_the_field_is_its_boundary() -> None:
    for kind in ("trk", "rte"):
        field = one(gpx_of(driven(), kind), "round.gpx")
        assert field.area == pytest.approx(20_000, abs=5)
        assert "track is taken as the boundary" in field.assumptions[0]
    passed = one(gpx_of(driven(30)), "round.gpx")
    assert passed.area == pytest.approx(20_000, abs=10)
    assert any("driven past its beginning" in warning for warning in passed.warnings)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (gpx_of(driven()[:250]), "does not come back to where it began: its ends are"),
        (gpx_of(driven()[:2]), "no three positions"),
        (gpx_of([driven()[0]] * 50), "no three positions apart"),
        (gpx_of([(10.0, 95.0)] * 4), "not latitude and longitude"),
        (gpx_of([]), "no track in it"),
        (
            b'<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><wpt lat="1" lon="2"/></gpx>',
            "only 1 single points",
        ),
        (b'<gpx version="1.1"><trk><trkseg><trkpt lat="x" lon="2"/></trkseg></trk></gpx>', "not sound GPX"),
    ],
)
def test_a_track_that_bounds_nothing_is_one_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence):
        read_fields(content, "round.gpx")


# --- ISOXML ----------------------------------------------------------------------------------------------------------


def lsg(ring: list[tuple[float, float]], kind: str) -> str:
    points = "".join(f'<PNT A="2" C="{latitude:.9f}" D="{longitude:.9f}"/>' for longitude, latitude in ring)
    return f'<LSG A="{kind}">{points}</LSG>'


OUTER, INNER = lsg(RECTANGLE[:-1], "1"), lsg(HOLE, "2")
PFD = f'<PFD A="PFD1" C="Long acre" D="20000"><PLN A="1">{OUTER}{INNER}</PLN></PFD>'


def pfd_of(*polygons: str) -> str:
    """A field of several polygon elements."""
    return f'<PFD A="PFD1" C="Long acre">{"".join(polygons)}</PFD>'


OUTER_PLN = f'<PLN A="1">{OUTER}</PLN>'


@pytest.mark.parametrize(
    "files",
    [
        {"TASKDATA.XML": task_data(PFD)},
        {"TaskData/taskdata.xml": task_data(PFD, version=3)},
        {"TASKDATA.XML": task_data(pfd_of(OUTER_PLN, f'<PLN A="1">{INNER}</PLN>'))},
        {"TASKDATA.XML": task_data(pfd_of(OUTER_PLN, f'<PLN A="1">{lsg(HOLE, "1")}</PLN>'))},
        {"TASKDATA.XML": task_data(pfd_of(OUTER_PLN, f'<PLN A="6" B="pylon">{lsg(HOLE, "1")}</PLN>'))},
        {
            "TASKDATA/TASKDATA.XML": task_data('<XFR A="PFD00000" B="1"/>'),
            "TASKDATA/pfd00000.xml": f"<XFC>{PFD}</XFC>".encode(),
        },
    ],
)
def test_isoxml_of_every_shape_is_read(files: dict[str, bytes], tmp_path: Path) -> None:
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(content)
    main = next(iter(files))
    for field in (one(zipped(files), "up.zip"), *read_fields(tmp_path), *read_fields(tmp_path / main)):
        assert (field.name, round(field.area)) == ("Long acre", 19_600)


def test_guidance_patterns_come_with_their_field() -> None:
    def pattern(kind: int, inside: str, more: str = "") -> str:
        return f'<GGP A="GGP{kind}" B="Group"><GPN A="GPN{kind}" B="Line {kind}" C="{kind}"{more}>{inside}</GPN></GGP>'

    ab, curve, point = lsg(RECTANGLE[:2], "5"), lsg(RECTANGLE[:4], "5"), lsg(RECTANGLE[:1], "5")
    groups = "".join(
        [
            pattern(1, ab),
            pattern(2, point, ' G="90"'),
            pattern(3, curve),
            pattern(4, point, ' H="50000"'),
            pattern(5, curve),
        ]
    )
    field = one(task_data(PFD.replace("</PFD>", groups + "</PFD>")), "TASKDATA.XML")
    assert [(line.name, line.type) for line in field.lines] == [
        ("Line 1", "ab"), ("Line 2", "a-plus"), ("Line 3", "curve"), ("Line 4", "pivot"),
    ]  # fmt: skip
    (_, start), (_, end) = field.lines[1].geometry.coordinates
    assert start == pytest.approx(end, abs=1e-6)
    assert "1 guidance lines in it have no use here" in field.warnings[0]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (task_data(""), "no field with a boundary"),
        (
            task_data('<PFD A="PFD1" C="x"/><XFR A="PFD00009" B="1"/>'),
            "its 1 fields have no boundary; PFD00009.XML is missing",
        ),
        (b"<html/>", "XML, but not ISOXML"),
        (task_data(PFD.replace('C="41', 'C="x')), "has the position 'x"),
        (task_data(PFD.replace('<LSG A="1">', '<LSG A="1"><PNT A="2" C="NaN" D="1"/>')), "not a number"),
    ],
)
def test_isoxml_without_a_field_is_one_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence):
        read_fields(content, "TASKDATA.XML")


def test_one_bad_field_does_not_take_the_others_with_it() -> None:
    tiny = lsg(ring_of(rectangle(2, 2, (300, 0))), "1")
    outside = f'<PLN A="3" B="pond">{lsg(ring_of(rectangle(20, 20, (190, 50))), "1")}</PLN>'
    content = task_data(
        PFD.replace("</PFD>", outside + "</PFD>")
        + f'<PFD A="PFD2" C="Strip"><PLN A="1">{tiny}</PLN></PFD><PFD A="PFD3"/>'
    )
    field = one(content, "TASKDATA.XML")
    assert any("'Strip' in it is refused: a field of 4.0 m2 is too small" in one for one in field.warnings)
    assert any("'pond' reaches outside" in one for one in field.warnings)
    assert any("1 fields in it have no boundary" in one for one in field.warnings)


# --- AgOpenGPS -------------------------------------------------------------------------------------------------------

ABOUT = "2024-May-01 10:00:00 AM\n$FieldDir\nLong acre\n$Offsets\n0,0\nConvergence\n0\nStartFix\n51.1,-0.2\n"
SQUARE = "$Boundary\nFalse\n4\n0,0,0\n100.5,0,0\n100.5,50.25,1.5\n0,50.25,3\nFalse\n3\n10,10,0\n20,10,0\n20,20,0\n"
TRACKS = (
    "$TrackLines\nAB 12\n0.5\n1.5,2.5\n30,40\n0\n2\nTrue\n0\nWave\n0.1\n0,0\n0,0\n0\n4\nTrue\n3\n0,0,0\n5,9,0\n9,30,0\n"
)


def test_an_agopengps_folder_is_read(tmp_path: Path) -> None:
    files = {"Field.txt": ABOUT, "Boundary.txt": SQUARE, "TrackLines.txt": TRACKS, "ABLines.txt": "old,90,1,2\n"}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    for field in (
        *read_fields(tmp_path),
        *read_fields(tmp_path / "Boundary.txt"),
        *read_fields(tmp_path / "Field.txt"),
    ):
        assert field.name == "Long acre"
        assert field.area == pytest.approx(100.5 * 50.25 - 50, rel=1e-3)
        assert [(line.name, line.type, len(line.geometry.coordinates)) for line in field.lines] == [
            ("AB 12", "ab", 2), ("Wave", "curve", 3),
        ]  # fmt: skip
    assert (
        one(zipped({f"Long acre/{name}": text.encode() for name, text in files.items()}), "up.zip").name == "Long acre"
    )


def test_decimal_commas_and_the_older_line_files_are_read() -> None:
    commas = "$Boundary\nFalse\n4\n0,000,0,000,0,000\n100,500,0,000,0,000\n100,500,50,250,1,500\n0,000,50,250,3,000\n"
    lines = "AB, north,90,000,1,500,2,500\n"
    curves = "$CurveLines\nWave\n0.1\n3\n0,0,0\n5.5,9.5,0\n9,30,0\n"
    files = {"Field.txt": ABOUT, "Boundary.txt": commas, "ABLines.txt": lines}
    field = one(zipped({name: text.encode() for name, text in files.items()}), "up.zip")
    assert field.area == pytest.approx(100.5 * 50.25, rel=1e-3)
    assert field.lines[0].name == "AB, north"
    del files["ABLines.txt"]
    curved = one(zipped({name: text.encode() for name, text in (files | {"CurveLines.txt": curves}).items()}), "up.zip")
    assert curved.lines[0].type == "curve"


@pytest.mark.parametrize(
    ("files", "sentence"),
    [
        ({"Boundary.txt": SQUARE}, "there is no Field.txt"),
        ({"Field.txt": ABOUT}, "holds no boundary"),
        ({"Field.txt": ABOUT.split("StartFix", maxsplit=1)[0], "Boundary.txt": SQUARE}, "no start fix"),
        (
            {"Field.txt": ABOUT.replace("$Offsets\n0,0", "$Offsets\n533172,5927719"), "Boundary.txt": SQUARE},
            "UTM offsets",
        ),
        ({"Field.txt": ABOUT.replace("51.1,-0.2", "north"), "Boundary.txt": SQUARE}, "is not a latitude and longitude"),
        ({"Field.txt": ABOUT, "Boundary.txt": SQUARE[:40]}, "it was cut off"),
        ({"Field.txt": ABOUT, "Boundary.txt": SQUARE.replace("100.5,0,0", "x")}, "not easting and northing"),
    ],
)
def test_a_broken_agopengps_folder_is_one_sentence(files: dict[str, str], sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence):
        read_fields(zipped({name: text.encode() for name, text in files.items()}), "up.zip")


# --- archives and tables ---------------------------------------------------------------------------------------------


def encrypted(content: bytes) -> bytes:
    """The archive with its members marked as encrypted."""
    marked = bytearray(content)
    for sign, place in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        at = content.find(sign)
        marked[at + place] |= 1
    return bytes(marked)


SOUND = zipped({"a.kml": kml_of(POLYGON)})


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (zipped({"../../etc/a.kml": kml_of(POLYGON)}), "leads outside of it"),
        (zipped({"/etc/a.kml": kml_of(POLYGON)}), "leads outside of it"),
        (zipped({"C:\\a.kml": kml_of(POLYGON)}), "leads outside of it"),
        (zipped({f"{n}.txt": b"" for n in range(10_001)}), "holds 10,001 files"),
        (zipped({"a.kml": bytes(60_000_000)}), "larger than 50 MB"),
        (zipped({f"{n}.kml": bytes(45_000_000) for n in range(5)}), "unpacks to 225 MB; 200 MB are the most"),
        (SOUND[:200], "not a sound zip archive"),
        (SOUND[:60] + b"\0\0\0\0" + SOUND[64:], "damaged"),
        (encrypted(SOUND), "is encrypted"),
        (zipped({"a.doc": b"x", "b": b"y"}), "only .doc, files without an ending"),
        (zipped({}), "holds no file at all"),
        (b"", "is empty"),
        (bytes(50_000_001), "larger than 50 MB"),
    ],
    ids=lambda one: one[:30] if isinstance(one, str) else "",
)
def test_an_archive_that_is_not_honest_is_refused_with_a_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence) as caught:
        read_fields(content, "up.zip")
    assert len(str(caught.value)) < 250


def test_japanese_names_in_archives_are_read() -> None:
    archive = zipped({"xxxx.csv": csv_of(LATLON)}).replace(b"xxxx.csv", "圃場".encode("cp932") + b".csv")
    assert one(archive, "up.zip").name == "圃場"


def test_an_upload_without_a_known_ending_is_told_what_is_possible() -> None:
    with pytest.raises(ExchangeError, match=r"fields are read from \.csv, .*not from '\.docx'"):
        read_fields(b"x", "a.docx")


def test_each_ending_is_lower_case_and_every_writer_has_a_reader() -> None:
    assert all(ending == ending.lower() and ending.startswith(".") for ending in (*READERS, *WRITERS))
    assert set(WRITERS) - {".zip"} <= set(READERS)


def test_geojson_in_an_archive_is_found() -> None:
    content = json.dumps({"type": "Polygon", "coordinates": [RECTANGLE]}).encode()
    assert one(zipped({"a.geojson": content, "readme.txt": b"hello"}), "up.zip").name == "a"
