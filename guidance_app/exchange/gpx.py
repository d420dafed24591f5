"""GPX: a track or route that was driven or walked round a field, one field each, by gpxpy."""

import gpxpy
import gpxpy.gpx

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.documents import Position
from guidance_app.exchange.asking import ReadOptions, briefly
from guidance_app.exchange.files import Files
from guidance_app.exchange.rings import ring_of_track
from guidance_app.exchange.xml_tree import parsed
from guidance_app.language import sentence

__all__ = ["read"]


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:  # noqa: ARG001 - GPX leaves nothing open
    """A draft for each track and route. Raises ``BoundaryError``."""
    content = files.content()
    parsed(content, "GPX")
    try:
        found = gpxpy.parse(content)
    except (gpxpy.gpx.GPXException, ValueError) as error:
        msg = sentence("it is not sound GPX ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error
    tracks: list[tuple[str | None, list[Position]]] = [
        (track.name, [(point.longitude, point.latitude) for segment in track.segments for point in segment.points])
        for track in found.tracks
    ]
    tracks += [(route.name, [(point.longitude, point.latitude) for point in route.points]) for route in found.routes]
    tracks = [(name, points) for name, points in tracks if points]
    if not tracks:
        if found.waypoints:
            msg = sentence("there is no track in it, only {count} single points", count=len(found.waypoints))
            raise BoundaryError(msg)
        raise BoundaryError(sentence("there is no track in it"))
    return tuple(_draft(name, points) for name, points in tracks)


def _draft(name: str | None, points: list[Position]) -> FieldDraft:
    ring, remarks = ring_of_track(points)
    cleaned = " ".join("".join(letter if letter.isprintable() else " " for letter in name or "").split())[:120]
    return FieldDraft(
        name=cleaned or None,
        parts=([ring],),
        remarks=remarks,
        assumptions=(sentence("the track is taken as the boundary, driven by the antenna itself"),),
    )
