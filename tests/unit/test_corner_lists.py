"""Lists of corners in text and spreadsheets: what is guessed is said, what cannot be guessed is asked."""

import io

import openpyxl
import pytest
import xlwt
from odf.opendocument import OpenDocumentSpreadsheet
from odf.table import Table, TableCell, TableRow
from odf.text import P
from support.documents import rectangle, ring_of
from support.field_files import LATLON, ONE_MILLIMETRE_ALL_ROUND, UTM30, csv_of, in_system, one, zipped

from guidance_app.exchange import ExchangeError, QuestionError, ReadOptions, read_fields
from guidance_app.geodesy import CoordinateSystem, Datum, Projection

COMMAS = [tuple(text.replace(".", ",") for text in row) for row in LATLON]


@pytest.mark.parametrize(
    "content",
    [
        csv_of(LATLON),
        csv_of([("lat", "lon"), *LATLON]),
        csv_of([("Punkt", "Länge", "Breite"), *((n, row[1], row[0]) for n, row in enumerate(LATLON))], ";"),
        csv_of([("緯度", "経度"), *LATLON]),
        csv_of([("緯度", "経度"), *LATLON]).decode().encode("cp932"),
        csv_of(COMMAS, ";"),
        csv_of(COMMAS, "\t"),
        csv_of(COMMAS, ","),
        csv_of([(n, *row) for n, row in enumerate(COMMAS, 1)], ","),
        csv_of(COMMAS, " "),
        csv_of(COMMAS, ", "),
        csv_of([(n, *row) for n, row in enumerate(LATLON, 1)]),
        csv_of([(n, *row) for n, row in enumerate(LATLON, 1)], " "),
        csv_of([(row[1].replace("-", "") + " W", row[0] + " N") for row in LATLON], ";"),
        b"# from a survey\n\n" + csv_of(LATLON) + b"\n\n",
        "\ufeff".encode("utf-16-le") + csv_of(LATLON).decode().encode("utf-16-le"),
    ],
)
def test_lists_of_corners_are_read_however_they_are_written(content: bytes) -> None:
    assert one(content, "corners.csv").area == pytest.approx(20_000, abs=ONE_MILLIMETRE_ALL_ROUND)


def test_what_a_list_left_open_is_said_and_can_be_asked_otherwise() -> None:
    field = one(csv_of(LATLON), "corners.txt")
    assert field.name == "corners"
    assert "north (latitude) first" in field.assumptions[0]
    turned = one(csv_of(LATLON), "corners.txt", ReadOptions(order="east first"))
    assert turned.assumptions == ()
    assert turned.geometry.coordinates[0][0][0] == pytest.approx(41.93, abs=0.01)
    assert one(csv_of([("lat", "lon"), *LATLON]), "a.csv").assumptions == ()
    commas = one(csv_of(COMMAS, ","), "a.csv")
    assert "decimal commas" in commas.assumptions[0]


def test_columns_that_are_headed_the_wrong_way_round_are_turned_and_said() -> None:
    there = [
        (f"{39.7 + 100 * east:.7f}", f"{139.6 + 100 * north:.7f}") for east, north in ((0, 0), (1e-5, 0), (1e-5, 1e-5))
    ]
    field = one(csv_of([("lon", "lat"), *there]), "a.csv")
    assert "headed the wrong way round" in field.assumptions[0]
    assert field.geometry.coordinates[0][0][0] > 139


def test_metres_ask_for_their_system_and_are_read_with_it() -> None:
    metres = [(f"{east:.3f}", f"{north:.3f}") for east, north in in_system(32630)]
    with pytest.raises(QuestionError, match="so they are metres: say in which system") as caught:
        read_fields(csv_of(metres), "a.csv")
    assert caught.value.option == "system"
    field = one(csv_of(metres), "a.csv", ReadOptions(system=UTM30))
    assert field.area == pytest.approx(20_000, abs=ONE_MILLIMETRE_ALL_ROUND)
    assert "east (longitude) first" in field.assumptions[0]
    turned = one(csv_of([row[::-1] for row in metres]), "a.csv", ReadOptions(system=UTM30))
    assert turned.geometry == field.geometry
    with pytest.raises(ExchangeError, match="row 1: easting"):
        read_fields(csv_of(LATLON), "a.csv", ReadOptions(system=UTM30))


def test_japanese_x_is_north_and_tokyo_needs_its_grid_or_consent() -> None:
    zone = CoordinateSystem(Projection.PLANE_RECTANGULAR, zone=9)
    square = [(-36258.1 + x, 12034.5 + y) for x, y in ((0, 0), (100, 0), (100, 50), (0, 50))]
    plain = one(csv_of(square), "a.csv", ReadOptions(system=zone))
    headed = one(csv_of([("X座標(m)", "Y座標(m)"), *square]), "a.csv", ReadOptions(system=zone))
    assert plain.geometry == headed.geometry
    assert plain.area == pytest.approx(5000, rel=3e-4)
    ring = plain.geometry.coordinates[0]
    assert max(y for _, y in ring) - min(y for _, y in ring) == pytest.approx(100 / 111e3, rel=0.01)
    tokyo = CoordinateSystem(Projection.PLANE_RECTANGULAR, Datum.TOKYO, 9)
    moved = one(csv_of(square), "a.csv", ReadOptions(system=tokyo))
    assert abs(moved.geometry.coordinates[0][0][1] - ring[0][1]) * 111e3 == pytest.approx(355, abs=20)
    at_sea = [(x + 30_000, y + 200_000) for x, y in square]
    with pytest.raises(QuestionError, match="only within 9 m") as caught:
        read_fields(csv_of(at_sea), "a.csv", ReadOptions(system=tokyo))
    assert caught.value.option == "inexact"
    assert one(csv_of(at_sea), "a.csv", ReadOptions(system=tokyo, inexact=True)).area == pytest.approx(5000, rel=1e-3)


def test_a_column_of_fields_makes_several() -> None:
    other = [(f"{latitude:.9f}", f"{longitude:.9f}") for longitude, latitude in ring_of(rectangle(50, 50, (500, 0)))]
    rows = [("Feld", "Breite", "Länge"), *(("A", *row) for row in LATLON), *(("B", *row) for row in other)]
    fields = read_fields(csv_of(rows, ";"), "list.csv")
    assert [(each.name, round(each.area)) for each in fields] == [("A", 20_000), ("B", 2500)]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"a,b\nc,d\n", "needs three corners|no two columns"),
        (b"1,2\n3,4\n", "a field needs three corners"),
        (csv_of([("lat", "lon"), *LATLON, ("x", "y")]), "row 6: 'x' is not a coordinate"),
        (csv_of([("lat", "lon"), *LATLON, ("", "5")]), "row 6: a coordinate is missing"),
        (csv_of([("lat", "lon"), *LATLON, ("nan", "5")]), "row 6: 'nan' is not a coordinate"),
        (b"name;note\nA;wet\nB;dry\nC;dry\n", "no two columns of coordinates"),
        (b"\xff\x00\x81\x81\x81", "not text|no two columns|needs three"),
        (csv_of([(0.0, 0.0), (0.00001, 0.0), (0.00001, 0.00001)]), "too small"),
        (csv_of([(0, 0), (10, 0), (10, 10)]), "km apart"),
        (csv_of([(41.0, -4.0), (41.0, -3.0), (42.0, -3.0)]), "km apart"),
    ],
)
def test_a_list_without_a_field_is_one_sentence(content: bytes, sentence: str) -> None:
    with pytest.raises(ExchangeError, match=sentence) as caught:
        read_fields(content, "corners.csv")
    assert str(caught.value).startswith("corners.csv: ")


def spreadsheets() -> list[tuple[str, bytes]]:
    rows: list[list[object]] = [["No", "Latitude", "Longitude"]]
    rows += [[number, float(row[0]), row[1]] for number, row in enumerate(LATLON, 1)]
    book = openpyxl.Workbook()
    book.create_sheet("Empty", 0)
    for row in rows:
        book["Sheet"].append(row)
    xlsx = io.BytesIO()
    book.save(xlsx)
    old = xlwt.Workbook()
    sheet = old.add_sheet("Corners")
    for y, row in enumerate(rows):
        for x, value in enumerate(row):
            sheet.write(y, x, value)
    xls = io.BytesIO()
    old.save(xls)
    document = OpenDocumentSpreadsheet()
    table = Table(name="Corners")
    for row in rows:
        line = TableRow()
        for value in row:
            cell = TableCell(valuetype="string")
            cell.addElement(P(text=str(value)))
            line.addElement(cell)
        table.addElement(line)
    document.spreadsheet.addElement(table)
    ods = io.BytesIO()
    document.write(ods)
    return [("a.xlsx", xlsx.getvalue()), ("a.xls", xls.getvalue()), ("a.ods", ods.getvalue())]


@pytest.mark.parametrize(("name", "content"), spreadsheets(), ids=lambda one: one if isinstance(one, str) else "")
def test_spreadsheets_are_lists_of_corners(name: str, content: bytes) -> None:
    field = one(content, name)
    assert field.area == pytest.approx(20_000, abs=ONE_MILLIMETRE_ALL_ROUND)
    if name == "a.xlsx":
        assert field.assumptions == ("of 2 sheets 'Sheet' is taken",)


def test_spreadsheets_without_corners_are_one_sentence() -> None:
    book = openpyxl.Workbook()
    empty = io.BytesIO()
    book.save(empty)
    for content, sentence in (
        (empty.getvalue(), "sheets are empty"),
        (b"PK\x03\x04 nothing", "not a sound spreadsheet"),
    ):
        with pytest.raises(ExchangeError, match=sentence):
            read_fields(content, "a.xlsx")
    with pytest.raises(ExchangeError, match="not a sound spreadsheet"):
        read_fields(b"nothing at all", "a.xls")
    bomb = zipped({"xl/worksheets/sheet1.xml": bytes(201_000_000)})
    with pytest.raises(ExchangeError, match="unpacks to 201 MB"):
        read_fields(bomb, "a.xlsx")
