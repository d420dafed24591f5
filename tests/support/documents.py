"""Documents for tests: small, valid, and different where a test asks for it."""

from guidance_app.boundary import checked_boundary
from guidance_app.documents import FieldDocument, Operation, Position, Tractor
from guidance_app.geodesy import FieldFrame

ORIGIN_DEG = (41.93, -4.87)


def ring_of(corners: list[tuple[float, float]], origin_deg: tuple[float, float] = ORIGIN_DEG) -> list[Position]:
    """A closed ring of longitude and latitude from corners in metres east and north of the origin."""
    frame = FieldFrame(*origin_deg)
    ring = []
    for east, north in corners:
        latitude, longitude = frame.degrees_from_east_north(east, north)
        ring.append((longitude, latitude))
    return [*ring, ring[0]]


def rectangle(width: float, height: float, at: tuple[float, float] = (0.0, 0.0)) -> list[tuple[float, float]]:
    """Corners in metres, counter-clockwise."""
    east, north = at
    return [(east, north), (east + width, north), (east + width, north + height), (east, north + height)]


def field_named(name: str, notes: str = "") -> FieldDocument:
    """A field of 1 ha with a hole of 100 m2."""
    rings = [ring_of(rectangle(100, 100)), ring_of(rectangle(10, 10, (40, 40)))]
    return FieldDocument(name=name, boundary=checked_boundary(rings).geometry, notes=notes)


def operation_named(name: str, field: str, tractor: str = "T") -> Operation:
    """An operation that refers to these."""
    return Operation(name=name, field=field, tractor=tractor, implement="I")


def tractor_named(name: str, wheelbase: float = 2.5) -> Tractor:
    """A tractor."""
    return Tractor(name=name, wheelbase=wheelbase)
