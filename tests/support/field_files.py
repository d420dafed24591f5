"""Files of other programs for tests, made by the programs' own libraries where there is one."""

import io
import zipfile
from collections.abc import Sequence

import openpyxl
import shapefile
from pyproj import Transformer

from guidance_app.documents import FieldDocument, GuidanceLineDocument, LineGeometry
from guidance_app.exchange import ImportedField, ReadOptions, read_fields
from guidance_app.geodesy import CoordinateSystem, Projection
from support.documents import field_named, rectangle, ring_of

__all__ = [
    "LATLON",
    "ONE_MILLIMETRE_ALL_ROUND",
    "RECTANGLE",
    "UTM30",
    "corners_text",
    "csv_of",
    "field_with_lines",
    "in_system",
    "kml_of",
    "one",
    "shapefile_parts",
    "spreadsheet_of",
    "task_data",
    "zipped",
]

RECTANGLE = ring_of(rectangle(200, 100))
"""2 ha, closed, counter-clockwise."""


def zipped(files: dict[str, bytes]) -> bytes:
    """An archive of these files."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return target.getvalue()


def kml_of(geometry: str, name: str = "Long acre", before: str = "") -> bytes:
    """A KML document with one placemark."""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>{before}<kml xmlns="http://www.opengis.net/kml/2.2"><Document>'
        f"<Folder><name>Farm</name><Placemark><name>{name}</name>{geometry}</Placemark></Folder></Document></kml>"
    ).encode()


def corners_text(ring: Sequence[tuple[float, float]]) -> str:
    """Longitude, latitude and height as KML has them."""
    return " ".join(f"{longitude:.9f},{latitude:.9f},0" for longitude, latitude in ring)


def shapefile_parts(
    shapes: Sequence[Sequence[Sequence[tuple[float, float]]]], names: Sequence[str], encoding: str = "utf-8"
) -> dict[str, bytes]:
    """The .shp, .shx and .dbf of polygons, without .prj and .cpg."""
    parts = {ending: io.BytesIO() for ending in ("shp", "shx", "dbf")}
    with shapefile.Writer(**parts, shapeType=shapefile.POLYGON, encoding=encoding) as writer:
        writer.field("NAME", "C", size=40)
        for rings, name in zip(shapes, names, strict=True):
            writer.poly([list(ring) for ring in rings])
            writer.record(name)
    return {f"fields.{ending}": part.getvalue() for ending, part in parts.items()}


def task_data(inside: str, version: int = 4) -> bytes:
    """TASKDATA.XML around these elements."""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><ISO11783_TaskData VersionMajor="{version}" VersionMinor="0"'
        f' DataTransferOrigin="1">{inside}</ISO11783_TaskData>'
    ).encode()


def field_with_lines(name: str = "Long acre") -> FieldDocument:
    """A field of 1 ha with a hole, an AB line and a curve."""
    field = field_named(name)
    ring = field.boundary.coordinates[0]
    lines = [
        GuidanceLineDocument(name="South edge", type="ab", geometry=LineGeometry(coordinates=ring[:2])),
        GuidanceLineDocument(name="Round", type="curve", geometry=LineGeometry(coordinates=ring[:4])),
    ]
    return field.model_copy(update={"lines": lines})


ONE_MILLIMETRE_ALL_ROUND = 0.6
"""m2 that a perimeter of 600 m gains when every corner is a millimetre off."""
UTM30 = CoordinateSystem(Projection.UTM, zone=30)


def one(content: bytes, name: str, options: ReadOptions | None = None) -> ImportedField:
    (field,) = read_fields(content, name, options)
    return field


def csv_of(rows: list[tuple[object, ...]], separator: str = ",") -> bytes:
    return "\n".join(separator.join(map(str, row)) for row in rows).encode()


LATLON = [(f"{latitude:.9f}", f"{longitude:.9f}") for longitude, latitude in RECTANGLE[:-1]]


def in_system(epsg: int) -> list[tuple[float, float]]:
    """East, north of the rectangle moved to Japan or where the system is at home."""
    return [Transformer.from_crs(4326, epsg, always_xy=True).transform(*corner) for corner in RECTANGLE[:-1]]


def spreadsheet_of(rows: Sequence[Sequence[object]]) -> bytes:
    """An XLSX workbook with one sheet of these rows."""
    book = openpyxl.Workbook()
    for row in rows:
        book["Sheet"].append(list(row))
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()
