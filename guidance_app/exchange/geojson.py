"""GeoJSON (RFC 7946, and the older form of 2008 whose ``crs`` member is honoured) to drafts, and fields to GeoJSON.

Each feature with a polygon is a field of its own; the parts of a MultiPolygon are parts of one field. Lines and points
belong to a field only in files that this program wrote, where the property ``guidance_app`` says what they are.
"""

import json
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from pydantic import ValidationError

from guidance_app.boundary import BoundaryError, FieldDraft, PolygonRings
from guidance_app.documents import FieldDocument, GuidanceLineDocument, LineGeometry, Position
from guidance_app.exchange.asking import ReadOptions, briefly, changed_from
from guidance_app.exchange.files import Files
from guidance_app.geodesy import crs_named
from guidance_app.language import sentence

__all__ = ["read", "written"]

ROLE = "guidance_app"
NAME_PROPERTIES = ("name", "Name", "NAME", "field_name", "FieldName", "label", "title", "id")
"""Where a field's name is looked for, first come first served; ``id`` at last."""
Change = Callable[[list[Position]], list[Position]]


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:
    """A draft for each feature with a polygon. Raises ``BoundaryError``."""
    root = _object(files.content())
    change = _change_of(root, options)
    features = _features(root)
    fields = [feature for feature in features if _kind_of(feature) in {"Polygon", "MultiPolygon"}]
    others = [feature for feature in features if _kind_of(feature) not in {"Polygon", "MultiPolygon", None}]
    if not fields:
        found = sorted({str(_kind_of(feature)) for feature in others})
        if found:
            raise BoundaryError(sentence("there is no polygon in it, only {names}", names=", ".join(found)))
        raise BoundaryError(sentence("there is no polygon in it"))
    ours = [feature for feature in others if ROLE in _properties(feature)]
    drafts = [_draft(feature, change) for feature in fields]
    if len(drafts) == 1 and ours:
        drafts = [_with_extras(drafts[0], ours, change)]
    ignored = len(others) - (len(ours) if len(drafts) == 1 else 0)
    if ignored:
        remark = sentence("{ignored} points and lines in the file are left out", ignored=ignored)
        drafts = [draft.remarked(remark) for draft in drafts]
    return tuple(drafts)


def written(document: FieldDocument) -> bytes:
    """The field as a FeatureCollection: the boundary, and if there are any its guidance lines and its entrance."""
    features = [
        _feature("boundary", document.boundary.model_dump(), {"name": document.name, "notes": document.notes}),
        *(
            _feature("line", line.geometry.model_dump(), {"name": line.name, "type": line.type})
            for line in document.lines
        ),
    ]
    if document.entrance is not None:
        features.append(_feature("entrance", {"type": "Point", "coordinates": document.entrance}, {}))
    collection = {"type": "FeatureCollection", "features": features}
    return (json.dumps(collection, ensure_ascii=False, indent=1) + "\n").encode()


def _feature(role: str, geometry: dict[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "properties": {ROLE: role, **properties}, "geometry": geometry}


# --- reading: the frame of the file ----------------------------------------------------------------------------------


def _object(content: bytes) -> dict[str, Any]:
    try:
        root = json.loads(content, parse_constant=_no_constant)
    except BoundaryError:
        raise
    except RecursionError as error:
        msg = sentence("it is nested too deeply to be GeoJSON")
        raise BoundaryError(msg) from error
    except ValueError as error:
        msg = sentence("it is not JSON ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error
    if not isinstance(root, dict):
        msg = sentence("it is JSON, but not a GeoJSON object")
        raise BoundaryError(msg)
    return root


def _no_constant(text: str) -> NoReturn:
    msg = sentence("it holds {text} where a number belongs", text=text)
    raise BoundaryError(msg)


def _features(root: dict[str, Any]) -> list[dict[str, Any]]:
    """Every feature; a bare geometry counts as one."""
    kind = root.get("type")
    if kind == "FeatureCollection":
        features = root.get("features")
        if not isinstance(features, list) or not all(isinstance(each, dict) for each in features):
            msg = sentence("its FeatureCollection has no list of features")
            raise BoundaryError(msg)
        return features
    if kind == "Feature":
        return [root]
    if kind in {"Polygon", "MultiPolygon"}:
        return [{"type": "Feature", "properties": {}, "geometry": root}]
    msg = sentence("it is JSON, but not GeoJSON with a polygon (its type is {kind!r})", kind=kind)
    raise BoundaryError(msg)


def _change_of(root: dict[str, Any], options: ReadOptions) -> Change:
    """What turns positions of the file into WGS 84 degrees, from the ``crs`` member of 2008."""
    crs = root.get("crs")
    if crs is None:
        return lambda positions: positions
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    if not isinstance(name, str):
        msg = sentence("its crs member does not name a coordinate system")
        raise BoundaryError(msg)
    try:
        system = crs_named(name)
    except ValueError as error:
        msg = sentence("its coordinate system '{name}' is not known", name=name[:60])
        raise BoundaryError(msg) from error
    return changed_from(system, options)


# --- reading: one feature --------------------------------------------------------------------------------------------


def _kind_of(feature: dict[str, Any]) -> str | None:
    geometry = feature.get("geometry")
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    return kind if isinstance(kind, str) else None


def _properties(feature: dict[str, Any]) -> dict[str, Any]:
    properties = feature.get("properties")
    return properties if isinstance(properties, dict) else {}


def _draft(feature: dict[str, Any], change: Change) -> FieldDraft:
    coordinates = feature["geometry"].get("coordinates")
    polygons = coordinates if _kind_of(feature) == "MultiPolygon" else [coordinates]
    if not isinstance(polygons, list) or not polygons:
        msg = sentence("a polygon in it has no coordinates")
        raise BoundaryError(msg)
    notes = _properties(feature).get("notes")
    return FieldDraft(
        name=_name_of(feature),
        parts=tuple(_polygon(polygon, change) for polygon in polygons),
        notes=notes if isinstance(notes, str) and ROLE in _properties(feature) else "",
    )


def _name_of(feature: dict[str, Any]) -> str | None:
    properties = _properties(feature)
    for key in NAME_PROPERTIES:
        value = properties.get(key)
        if isinstance(value, str | int) and not isinstance(value, bool) and str(value).strip():
            printable = "".join(letter if letter.isprintable() else " " for letter in str(value))
            return " ".join(printable.split())[:120] or None
    return None


def _polygon(rings: Any, change: Change) -> PolygonRings:
    if not isinstance(rings, list) or not rings:
        msg = sentence("a polygon in it has no rings")
        raise BoundaryError(msg)
    return [_positions(ring, change) for ring in rings]


def _positions(ring: Any, change: Change) -> list[Position]:
    if not isinstance(ring, list) or not ring:
        msg = sentence("a ring in it has no corners")
        raise BoundaryError(msg)
    return change([_numbers(corner) for corner in ring])


def _numbers(corner: Any) -> Position:
    if not isinstance(corner, list) or len(corner) < 2 or not all(_is_number(value) for value in corner[:2]):
        msg = sentence("a corner in it is {corner!r}, not two numbers", corner=str(corner)[:40])
        raise BoundaryError(msg)
    try:
        return float(corner[0]), float(corner[1])
    except OverflowError as error:
        msg = sentence("a corner in it is not a number of sensible size")
        raise BoundaryError(msg) from error


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


# --- reading: what this program wrote beside the boundary ------------------------------------------------------------


def _with_extras(draft: FieldDraft, features: Sequence[dict[str, Any]], change: Change) -> FieldDraft:
    lines: list[GuidanceLineDocument] = []
    entrance: Position | None = None
    for feature in features:
        coordinates = feature["geometry"].get("coordinates")
        match _properties(feature)[ROLE]:
            case "line":
                lines.append(_line(feature, _positions(coordinates, change)))
            case "entrance":
                (entrance,) = change([_numbers(coordinates)])
            case other:
                msg = sentence("a feature in it has the unknown part '{other}' of a field", other=other)
                raise BoundaryError(msg)
    return draft.with_extras(lines, entrance)


def _line(feature: dict[str, Any], positions: list[Position]) -> GuidanceLineDocument:
    properties = _properties(feature)
    try:
        return GuidanceLineDocument.model_validate(
            {
                "name": properties.get("name"),
                "type": properties.get("type", "ab"),
                "geometry": LineGeometry(coordinates=positions),
            }
        )
    except ValidationError as error:
        msg = sentence("a guidance line in it cannot be read: {reason}", reason=error.errors()[0]["msg"])
        raise BoundaryError(msg) from error
