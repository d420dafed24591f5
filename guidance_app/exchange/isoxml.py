"""ISOXML (ISO 11783-10, versions 3 and 4) to drafts, and fields to TASKDATA.XML of version 4.

A folder, a zip archive or the bare file; names in any case; fields in external files (XFR) are followed. Exclusions
may stand in the boundary's polygon or in a polygon of their own. Guidance patterns come with their field.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from pydantic import ValidationError

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.documents import FieldDocument, GuidanceLineDocument, LineGeometry, Position
from guidance_app.exchange.asking import ReadOptions
from guidance_app.exchange.files import Files
from guidance_app.exchange.rings import polygons_of
from guidance_app.exchange.xml_tree import Element, children, first, local_name, parsed, quoted
from guidance_app.geodesy import FieldFrame
from guidance_app.language import sentence

__all__ = ["TASKDATA", "designator", "field_element", "read", "root_of", "task_data", "written"]

TASKDATA = "TASKDATA.XML"
BOUNDARY = "1"
OBSTACLES = {"3": "water surface", "4": "building", "6": "obstacle"}
"""Types of polygon that are ground one cannot work."""
EXTERIOR, INTERIOR, PATTERN = "1", "2", "5"
"""Types of line string."""
PATTERNS = {"1": "ab", "2": "a-plus", "3": "curve", "4": "pivot"}
KINDS = {kind: number for number, kind in PATTERNS.items()}
A_PLUS_LENGTH = 100.0
"""Metres of the line that stands for a point and a heading."""
PIVOT_RADIUS = 1.0
Ring = list[Position]


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:  # noqa: ARG001 - ISOXML leaves nothing open
    """A draft for each field with a boundary. Raises ``BoundaryError``."""
    root, missing = root_of(files)
    fields = list(children(root, "PFD"))
    drafts = [draft for number, field in enumerate(fields, start=1) if (draft := _draft(field, number)) is not None]
    if not drafts:
        raise BoundaryError(_nothing(len(fields), missing))
    remarks = [sentence("{name} belongs to it and is missing", name=name) for name in missing]
    if len(drafts) < len(fields):
        remarks.append(
            sentence("{count} fields in it have no boundary and are left out", count=len(fields) - len(drafts))
        )
    for remark in remarks:
        drafts = [each.remarked(remark) for each in drafts]
    return tuple(drafts)


def _nothing(fields: int, missing: list[str]) -> str:
    """Why there is no field, and what that may have to do with."""
    said = sentence("there is no field with a boundary in it")
    if fields:
        said = sentence("{reason}; its {count} fields have no boundary", reason=said, count=fields)
    return sentence("{reason}; {names} is missing", reason=said, names=", ".join(missing)) if missing else said


def root_of(files: Files) -> tuple[Element, list[str]]:
    """The task data with the external files' elements added, and the names of the missing ones."""
    name = files.called(TASKDATA) or files.main
    if not name:
        msg = sentence("there is no {name} in it", name=TASKDATA)
        raise BoundaryError(msg)
    root = parsed(files.content(name), "ISOXML")
    if local_name(root) != "ISO11783_TaskData":
        msg = sentence("it is XML, but not ISOXML (it begins with <{root}>)", root=local_name(root)[:40])
        raise BoundaryError(msg)
    missing = []
    for reference in list(children(root, "XFR")):
        wanted = reference.get("A", "")
        outside = files.called(f"{wanted}.xml") or files.called(wanted)
        if outside is None:
            missing.append(f"{wanted[:40]}.XML")
            continue
        root.extend(list(parsed(files.content(outside), "ISOXML")))
    return root, missing


def written(document: FieldDocument) -> bytes:
    """TASKDATA.XML of version 4 with the field and its guidance lines."""
    return task_data([field_element(document)])


def task_data(elements: Sequence[str]) -> bytes:
    """TASKDATA.XML around these elements."""
    body = "\n".join(elements)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<ISO11783_TaskData VersionMajor="4" VersionMinor="3" ManagementSoftwareManufacturer="guidance-app"'
        ' ManagementSoftwareVersion="1" DataTransferOrigin="1">\n'
        f"{body}\n</ISO11783_TaskData>\n"
    ).encode()


# --- reading ---------------------------------------------------------------------------------------------------------


def _draft(field: Element, number: int) -> FieldDraft | None:
    outer: list[Ring] = []
    inner: list[Ring] = []
    obstacles: list[tuple[str, Ring]] = []
    for polygon in children(field, "PLN"):
        kind = polygon.get("A", BOUNDARY)
        for line in children(polygon, "LSG"):
            ring = _points(line)
            if len(ring) < 3:
                continue
            if kind == BOUNDARY:
                (inner if line.get("A") == INTERIOR else outer).append(ring)
            elif kind in OBSTACLES and line.get("A") != INTERIOR:
                obstacles.append((polygon.get("B") or OBSTACLES[kind], ring))
    if not outer:
        return None
    remarks: list[str] = []
    said: list[str] = []
    for name, ring in obstacles:
        if _is_inside(ring, outer):
            inner.append(ring)
            said.append(sentence("'{name}' inside the boundary is taken as an exclusion", name=_printable(name)))
        else:
            remarks.append(sentence("'{name}' reaches outside the boundary and is left out", name=_printable(name)))
    lines, unread = _lines(field)
    if unread:
        remarks.append(
            sentence(
                "{unread} guidance lines in it have no use here (spirals, or too few points) and are left out",
                unread=unread,
            )
        )
    name = _printable(field.get("C") or field.get("B") or "") or f"Field {number}"
    return FieldDraft(
        name=name,
        parts=polygons_of([*outer, *inner]),
        lines=tuple(lines),
        remarks=tuple(remarks),
        assumptions=tuple(said),
    )


def _printable(text: str) -> str:
    return " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())[:120]


def _is_inside(ring: Ring, outer: Sequence[Ring]) -> bool:
    corners = np.asarray(ring)
    return any(np.all(shapely.contains_xy(shapely.Polygon(one), corners[:, 0], corners[:, 1])) for one in outer)


def _points(line: Element) -> Ring:
    return [_position(point) for point in children(line, "PNT")]


def _position(point: Element) -> Position:
    try:
        return float(point.get("D", "")), float(point.get("C", ""))
    except ValueError as error:
        msg = sentence(
            "a point in it has the position '{latitude}', '{longitude}'",
            latitude=point.get("C", "")[:20],
            longitude=point.get("D", "")[:20],
        )
        raise BoundaryError(msg) from error


def _lines(field: Element) -> tuple[list[GuidanceLineDocument], int]:
    """The guidance lines of a field, and how many of them cannot be used."""
    found: list[GuidanceLineDocument] = []
    unread = 0
    for group, pattern in _patterns(field):
        kind = PATTERNS.get(pattern.get("C", ""))
        line = first(pattern, "LSG")
        points = [] if line is None or kind is None else _shaped(kind, pattern, _points(line))
        if kind is None or len(points) < 2:
            unread += 1
            continue
        name = _printable(pattern.get("B") or group.get("B") or "") or f"Line {len(found) + 1}"
        try:
            found.append(
                GuidanceLineDocument.model_validate(
                    {"name": name, "type": kind, "geometry": LineGeometry(coordinates=points)}
                )
            )
        except ValidationError as error:
            msg = sentence(
                "its guidance line '{name}' cannot be read: {reason}", name=name, reason=error.errors()[0]["msg"]
            )
            raise BoundaryError(msg) from error
    return found, unread


def _patterns(field: Element) -> Iterator[tuple[Element, Element]]:
    for group in children(field, "GGP"):
        for pattern in children(group, "GPN"):
            yield group, pattern


def _shaped(kind: str, pattern: Element, points: Ring) -> Ring:
    """The points as a field stores them: A+ as a line of 100 m, a pivot as its centre and a point on its circle."""
    if kind == "ab":
        return [points[0], points[-1]] if len(points) > 1 else []
    if kind == "a-plus" and points:
        heading = _attribute(pattern, "G")
        return points if heading is None else [points[0], _moved(points[0], heading, A_PLUS_LENGTH)]
    if kind == "pivot" and len(points) == 1:
        radius = _attribute(pattern, "H")
        metres = PIVOT_RADIUS if radius is None else radius / 1000
        return [points[0], _moved(points[0], 0.0, metres)]
    return points


def _attribute(element: Element, name: str) -> float | None:
    try:
        return float(element.get(name, ""))
    except ValueError:
        return None


def _moved(start: Position, heading_deg: float, metres: float) -> Position:
    try:
        frame = FieldFrame(start[1], start[0])
    except ValueError as error:
        msg = sentence(
            "a guidance line in it lies at {latitude:g}, {longitude:g}, which is not latitude and longitude",
            latitude=start[1],
            longitude=start[0],
        )
        raise BoundaryError(msg) from error
    heading = math.radians(heading_deg)
    latitude, longitude = frame.degrees_from_east_north(metres * math.sin(heading), metres * math.cos(heading))
    return longitude, latitude


# --- writing ---------------------------------------------------------------------------------------------------------


def field_element(document: FieldDocument, number: int = 1) -> str:
    """The PFD element of a field; ``number`` makes its identifier."""
    frame = FieldFrame(document.boundary.coordinates[0][0][1], document.boundary.coordinates[0][0][0])
    rings = [frame.array_from_lonlat(ring) for ring in document.boundary.coordinates]
    area = round(shapely.Polygon(rings[0], rings[1:]).area)
    strings = "".join(
        f'<LSG A="{EXTERIOR if place == 0 else INTERIOR}">{_points_text(ring, "10")}</LSG>'
        for place, ring in enumerate(document.boundary.coordinates)
    )
    groups = "".join(_group_text(line, place) for place, line in enumerate(document.lines, start=1))
    return (
        f'<PFD A="PFD{number}" C={quoted(designator(document.name))} D="{area}">'
        f'<PLN A="{BOUNDARY}" C="{area}">{strings}</PLN>{groups}</PFD>'
    )


def designator(text: str) -> str:
    """At most 32 characters, as designators have in both versions."""
    return text[:32].rstrip()


def _group_text(line: GuidanceLineDocument, number: int) -> str:
    corners = line.geometry.coordinates
    name = quoted(designator(line.name))
    heading = ""
    if line.type == "a-plus":
        frame = FieldFrame(corners[0][1], corners[0][0])
        east, north = frame.array_from_lonlat([corners[-1]])[0]
        heading = f' G="{math.degrees(math.atan2(east, north)) % 360:.9f}"'
        corners = corners[:1]
    return (
        f'<GGP A="GGP{number}" B={name}><GPN A="GPN{number}" B={name} C="{KINDS[line.type]}"{heading}>'
        f'<LSG A="{PATTERN}">{_guidance_points(line.type, corners)}</LSG></GPN></GGP>'
    )


def _guidance_points(kind: str, corners: Sequence[Position]) -> str:
    """Points with their parts: A, B, the points between, or a pivot's centre."""
    if kind == "pivot":
        return _point("8", corners[0]) + "".join(_point("9", one) for one in corners[1:])
    if len(corners) == 1:
        return _point("6", corners[0])
    between = "".join(_point("9", one) for one in corners[1:-1])
    return _point("6", corners[0]) + between + _point("7", corners[-1])


def _points_text(ring: Ring, kind: str) -> str:
    return "".join(_point(kind, corner) for corner in ring)


def _point(kind: str, corner: Position) -> str:
    longitude, latitude = corner
    return f'<PNT A="{kind}" C="{latitude:.9f}" D="{longitude:.9f}"/>'
