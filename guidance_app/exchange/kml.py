"""KML and KMZ, as Google Earth and farm programs write them, to drafts; and fields to KML.

Each placemark with a polygon is a field, the parts of its MultiGeometry are the field's parts. A file without any
polygon may hold the boundary as a closed path. Other lines and points belong to a field only in files that this
program wrote, where the extended data ``guidance_app`` say what they are.
"""

import re
from collections.abc import Iterator, Sequence

from pydantic import ValidationError

from guidance_app.boundary import BoundaryError, FieldDraft, PolygonRings
from guidance_app.documents import FieldDocument, GuidanceLineDocument, LineGeometry, Position
from guidance_app.exchange.asking import ReadOptions
from guidance_app.exchange.files import Files
from guidance_app.exchange.xml_tree import Element, children, first, local_name, parsed, quoted, text_of, written_text
from guidance_app.language import sentence

__all__ = ["coordinates_text", "document_of", "placemark", "read", "written"]

ROLE = "guidance_app"
_find_corners = re.compile(r"[^\s,]+(?:\s*,\s*[^\s,]+)+").findall


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:  # noqa: ARG001 - KML leaves nothing open
    """A draft for each placemark with a polygon, of a KML file or of an archive's. Raises ``BoundaryError``."""
    names = [files.main] if files.main else files.ending(".kml")
    if not names:
        msg = sentence("no .kml file is in the archive")
        raise BoundaryError(msg)
    drafts = [draft for name in names for draft in _drafts(parsed(files.content(name), "KML"))]
    if not drafts:
        msg = sentence("there is no polygon in it, nor a closed path")
        raise BoundaryError(msg)
    return tuple(drafts)


def written(document: FieldDocument) -> bytes:
    """The field as a placemark, and one for each guidance line and the entrance."""
    marks = [placemark(document.name, _polygon_text(document), {ROLE: "boundary", "notes": document.notes})]
    for line in document.lines:
        geometry = f"<LineString>{coordinates_text(line.geometry.coordinates)}</LineString>"
        marks.append(placemark(line.name, geometry, {ROLE: "line", "type": line.type}))
    if document.entrance is not None:
        geometry = f"<Point>{coordinates_text([document.entrance])}</Point>"
        marks.append(placemark("Entrance", geometry, {ROLE: "entrance"}))
    return document_of(document.name, marks)


def document_of(name: str, marks: Sequence[str]) -> bytes:
    """A KML document of placemarks."""
    body = "\n".join(marks)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<kml xmlns="http://www.opengis.net/kml/2.2">\n<Document>\n<name>{written_text(name)}</name>\n{body}\n'
        "</Document>\n</kml>\n"
    ).encode()


def placemark(name: str, geometry: str, data: dict[str, str]) -> str:
    """A placemark; ``geometry`` is KML, ``data`` its extended data without the empty ones."""
    extended = "".join(
        f"<Data name={quoted(key)}><value>{written_text(value)}</value></Data>" for key, value in data.items() if value
    )
    inner = f"<ExtendedData>{extended}</ExtendedData>" if extended else ""
    return f"<Placemark><name>{written_text(name)}</name>{inner}{geometry}</Placemark>"


def coordinates_text(corners: Sequence[Position]) -> str:
    """``<coordinates>`` of longitude and latitude."""
    text = " ".join(f"{longitude:.9f},{latitude:.9f}" for longitude, latitude in corners)
    return f"<coordinates>{text}</coordinates>"


def _polygon_text(document: FieldDocument) -> str:
    rings = [f"<LinearRing>{coordinates_text(ring)}</LinearRing>" for ring in document.boundary.coordinates]
    outer, *holes = rings
    inner = "".join(f"<innerBoundaryIs>{hole}</innerBoundaryIs>" for hole in holes)
    return f"<Polygon><outerBoundaryIs>{outer}</outerBoundaryIs>{inner}</Polygon>"


# --- reading ---------------------------------------------------------------------------------------------------------


def _drafts(root: Element) -> list[FieldDraft]:
    marks = list(_placemarks(root, ""))
    fields = [(mark, folder, polygons) for mark, folder in marks if (polygons := list(_geometries(mark, "Polygon")))]
    others = [mark for mark, _ in marks if not any(_geometries(mark, "Polygon"))]
    if not fields:
        return [draft for mark, folder in marks for draft in _paths(mark, folder)]
    drafts = [_draft(mark, folder, polygons) for mark, folder, polygons in fields]
    ours = [mark for mark in others if ROLE in _data(mark)] if len(drafts) == 1 else []
    if ours:
        drafts = [_with_extras(drafts[0], ours)]
    left_out = sum(1 for mark in others if mark not in ours and any(_geometries(mark, "LineString", "Point")))
    if left_out:
        drafts = [each.remarked(f"{left_out} points and lines in the file are left out") for each in drafts]
    return drafts


def _placemarks(element: Element, folder: str) -> Iterator[tuple[Element, str]]:
    """Every placemark with the name of the folder that it lies in."""
    for child in element:
        match local_name(child):
            case "Placemark":
                yield child, folder
            case "Document" | "Folder" | "kml":
                yield from _placemarks(child, text_of(first(child, "name")) or folder)
            case _:
                pass


def _geometries(element: Element, *kinds: str) -> Iterator[Element]:
    for child in element:
        if local_name(child) in kinds:
            yield child
        elif local_name(child) == "MultiGeometry":
            yield from _geometries(child, *kinds)


def _data(mark: Element) -> dict[str, str]:
    extended = first(mark, "ExtendedData")
    if extended is None:
        return {}
    found = {each.get("name", ""): text_of(first(each, "value")) for each in children(extended, "Data")}
    for schema in children(extended, "SchemaData"):
        found |= {each.get("name", ""): text_of(each) for each in children(schema, "SimpleData")}
    return found


def _draft(mark: Element, folder: str, polygons: Sequence[Element]) -> FieldDraft:
    data = _data(mark)
    return FieldDraft(
        name=_name(mark, folder),
        parts=tuple(_rings(polygon) for polygon in polygons),
        notes=data.get("notes", "") if ROLE in data else "",
    )


def _name(mark: Element, folder: str) -> str | None:
    for text in (text_of(first(mark, "name")), _data(mark).get("name", ""), folder):
        printable = " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())
        if printable:
            return printable[:120]
    return None


def _rings(polygon: Element) -> PolygonRings:
    outer = first(polygon, "outerBoundaryIs", "LinearRing")
    if outer is None:
        msg = sentence("a polygon in it has no outer ring")
        raise BoundaryError(msg)
    inner = [ring for each in children(polygon, "innerBoundaryIs") for ring in children(each, "LinearRing")]
    return [_corners(ring) for ring in (outer, *inner)]


def _corners(element: Element) -> list[Position]:
    text = text_of(first(element, "coordinates"))
    found = []
    for corner in _find_corners(text):
        numbers = [part.strip() for part in corner.split(",")]
        try:
            found.append((float(numbers[0]), float(numbers[1])))
        except ValueError as error:
            msg = sentence("a corner in it is '{corner}', not two numbers", corner=corner[:40])
            raise BoundaryError(msg) from error
    if not found:
        msg = sentence("a ring or line in it has no corners")
        raise BoundaryError(msg)
    return found


def _paths(mark: Element, folder: str) -> list[FieldDraft]:
    """Closed paths, for a file in which somebody drew the boundary as one."""
    drafts = []
    for line in _geometries(mark, "LineString", "LinearRing"):
        corners = _corners(line)
        if len(corners) > 3 and (corners[0] == corners[-1] or local_name(line) == "LinearRing"):
            said = (sentence("there is no polygon in the file; the closed path is taken as the boundary"),)
            drafts.append(FieldDraft(_name(mark, folder), ([corners],), assumptions=said))
    return drafts


def _with_extras(draft: FieldDraft, marks: Sequence[Element]) -> FieldDraft:
    """What this program wrote beside the boundary."""
    lines: list[GuidanceLineDocument] = []
    entrance: Position | None = None
    for mark in marks:
        data = _data(mark)
        for geometry in _geometries(mark, "LineString", "Point"):
            corners = _corners(geometry)
            if data[ROLE] == "entrance":
                entrance = corners[0]
                continue
            try:
                lines.append(
                    GuidanceLineDocument.model_validate(
                        {
                            "name": text_of(first(mark, "name")),
                            "type": data.get("type", "ab"),
                            "geometry": LineGeometry(coordinates=corners),
                        }
                    )
                )
            except ValidationError as error:
                msg = sentence("a guidance line in it cannot be read: {reason}", reason=error.errors()[0]["msg"])
                raise BoundaryError(msg) from error
    return draft.with_extras(lines, entrance)
