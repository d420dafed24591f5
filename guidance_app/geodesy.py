"""The field frame: local transverse Mercator on WGS 84, scale 1, origin at the field; all by pyproj.

Beside it the coordinate systems that people type and files hold: degrees, UTM and the Japanese plane rectangular zones
(X is north, Y is east), on the world datum (WGS 84 and JGD2011, taken as one) or on the Tokyo datum. Systems are found
by EPSG code, never by name. Tokyo needs the grid of the optional package ``tky2jgd``: without it a position is up to
9 m off and the change is refused unless that is accepted. The grid leads to JGD2000; where the ground moved in 2011
(up to 5 m in the north-east of Honshu), old Tokyo coordinates stay off by that.

Never computed in UTM (400 ppm short: 100 passes of 12 m miss 0.48 m, and north is up to 2 degrees off) nor with a
spherical radius (33 mm per 12 m). Within 5 km of the origin the frame's scale is off by less than 0.4 ppm.
"""

import functools
import importlib
import importlib.resources
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from pyproj import CRS, Transformer
from pyproj.exceptions import CRSError, ProjError
from pyproj.transformer import TransformerGroup

from guidance_app.language import message, sentence
from guidance_app.model import FloatArray

__all__ = [
    "MAX_REACH",
    "CoordinateSystem",
    "Datum",
    "DatumError",
    "FieldFrame",
    "Projection",
    "crs_named",
    "grid_cell",
    "lonlat_from",
    "lonlat_to",
]

METRES_PER_MINUTE = 1852.0
"""One minute of latitude, in the sense of the nautical mile."""

MAX_REACH = 100_000.0
"""Farther from its origin than this, a field frame is refused."""


@dataclass(frozen=True, slots=True)
class FieldFrame:
    """East and north in metres of a tangent frame at ``origin``; true north, one metre is one metre.

    Raises ``ValueError`` for an origin that is not on earth or nearer than 1 degree to a pole.
    """

    latitude_deg: float
    longitude_deg: float
    _transformer: Transformer = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Checks the origin and builds the projection once."""
        if not (abs(self.latitude_deg) <= 89 and abs(self.longitude_deg) <= 180):
            msg = sentence(
                "{latitude}, {longitude} cannot be the origin of a field: latitude within 89 and longitude "
                "within 180 degrees are needed",
                latitude=self.latitude_deg,
                longitude=self.longitude_deg,
            )
            raise ValueError(msg)
        projection = (
            f"+proj=tmerc +lat_0={self.latitude_deg!r} +lon_0={self.longitude_deg!r}"
            " +k=1 +x_0=0 +y_0=0 +ellps=WGS84 +units=m +no_defs"
        )
        transformer = Transformer.from_crs("EPSG:4326", projection, always_xy=True)
        object.__setattr__(self, "_transformer", transformer)

    def east_north_from_degrees(self, latitude_deg: float, longitude_deg: float) -> tuple[float, float]:
        """Metres (east, north) of a WGS 84 position. Raises ``ValueError`` beyond 100 km from the origin."""
        east, north = self._transformer.transform(longitude_deg, latitude_deg)
        if not math.hypot(east, north) <= MAX_REACH:
            msg = sentence(
                "{latitude:.6f}, {longitude:.6f} is more than 100 km from the field",
                latitude=latitude_deg,
                longitude=longitude_deg,
            )
            raise ValueError(msg)
        return float(east), float(north)

    def degrees_from_east_north(self, east: float, north: float) -> tuple[float, float]:
        """WGS 84 (latitude, longitude) in degrees of a position in the frame."""
        longitude, latitude = self._transformer.transform(east, north, direction="INVERSE")
        return float(latitude), float(longitude)

    def array_from_lonlat(self, lonlat_deg: Sequence[tuple[float, float]] | FloatArray) -> FloatArray:
        """Shape (N, 2): east, north; from shape (N, 2): longitude, latitude in degrees, as GeoJSON orders them."""
        points = np.asarray(lonlat_deg, dtype=float).reshape(-1, 2)
        east, north = self._transformer.transform(points[:, 0], points[:, 1])
        return np.column_stack([east, north])

    def lonlat_from_array(self, points: FloatArray) -> FloatArray:
        """Shape (N, 2): longitude, latitude in degrees; from shape (N, 2): east, north."""
        longitude, latitude = self._transformer.transform(points[:, 0], points[:, 1], direction="INVERSE")
        return np.column_stack([longitude, latitude])


def grid_cell(latitude_deg: float, decimals: int) -> tuple[float, float]:
    """The receiver's rounding (north, east) in metres, from the decimals of a minute in its sentence.

    North 1852 m x 10^-decimals; east the same times the cosine of the latitude (Gomez-Gil et al. 2013, section 2).
    """
    north = METRES_PER_MINUTE * 10.0**-decimals
    return north, north * math.cos(math.radians(latitude_deg))


# --- the systems that people type and files hold ---------------------------------------------------------------------


class Datum(StrEnum):
    """The realisation of the earth that coordinates refer to."""

    WORLD = "world"
    TOKYO = "tokyo"


class Projection(StrEnum):
    """How coordinates are written."""

    GEOGRAPHIC = "geographic"
    UTM = "utm"
    PLANE_RECTANGULAR = "plane rectangular"


TOKYO_EPSG = 4301
JGD2011_EPSG = 6668
PLANE_ZONES = 19
TOKYO_UTM_ZONES = range(51, 56)
EXACT = 1.0
"""Metres; a change of datum that is less accurate is refused unless it is accepted."""
TOKYO_WITHOUT_GRID = 9.0
"""Metres that the three-parameter change of the Tokyo datum may be off."""
ARCSECONDS = 3600.0
TURNS_BACK = 6
"""Fixed-point steps of the inverse grid; each shrinks the error ten thousandfold."""


@dataclass(frozen=True, slots=True)
class CoordinateSystem:
    """How a pair of numbers is meant. Raises ``ValueError`` for a zone that does not exist."""

    projection: Projection = Projection.GEOGRAPHIC
    datum: Datum = Datum.WORLD
    zone: int | None = None
    south: bool = False

    def __post_init__(self) -> None:
        """Checks that the zone belongs to the projection."""
        match self.projection:
            case Projection.GEOGRAPHIC:
                allowed, what = range(0), sentence("degrees have no zone")
            case Projection.PLANE_RECTANGULAR:
                allowed, what = range(1, PLANE_ZONES + 1), sentence("plane rectangular zones go from 1 to 19")
            case Projection.UTM if self.datum is Datum.TOKYO:
                allowed, what = TOKYO_UTM_ZONES, sentence("UTM zones on the Tokyo datum go from 51 to 55")
            case Projection.UTM:
                allowed, what = range(1, 61), sentence("UTM zones go from 1 to 60")
        if self.projection is Projection.GEOGRAPHIC:
            if self.zone is not None:
                msg = sentence("degrees have no zone; {zone} was given", zone=self.zone)
                raise ValueError(msg)
        elif self.zone not in allowed:
            msg = sentence(
                "{what}; {zone} was given", what=what, zone=sentence("none") if self.zone is None else self.zone
            )
            raise ValueError(msg)
        if self.south and (self.projection is not Projection.UTM or self.datum is Datum.TOKYO):
            msg = sentence("only UTM on the world datum has a southern hemisphere")
            raise ValueError(msg)

    @property
    def plane(self) -> bool:
        """Whether it is written in metres."""
        return self.projection is not Projection.GEOGRAPHIC

    @property
    def words(self) -> str:
        """What a person calls it."""
        match self.projection:
            case Projection.GEOGRAPHIC:
                said = sentence("degrees")
            case Projection.UTM:
                pattern = message("UTM zone {zone} south") if self.south else message("UTM zone {zone} north")
                said = sentence(pattern, zone=self.zone)
            case Projection.PLANE_RECTANGULAR:
                said = sentence("Japanese plane rectangular zone {zone}", zone=self.zone)
        if self.datum is Datum.TOKYO:
            return sentence("{system}, tokyo datum", system=said)
        return sentence("{system}, world datum", system=said)

    @property
    def epsg(self) -> int:
        """The code of the system; JGD2011 stands for the world datum where Japan is meant."""
        zone = self.zone or 0
        match self.projection, self.datum:
            case Projection.GEOGRAPHIC, Datum.WORLD:
                return 4326
            case Projection.GEOGRAPHIC, Datum.TOKYO:
                return TOKYO_EPSG
            case Projection.UTM, Datum.WORLD:
                return (32700 if self.south else 32600) + zone
            case Projection.UTM, Datum.TOKYO:
                return 3092 - TOKYO_UTM_ZONES.start + zone
            case Projection.PLANE_RECTANGULAR, Datum.WORLD:
                return JGD2011_EPSG + zone
            case _:
                return 30160 + zone


class DatumError(ValueError):
    """A change of datum that is not known well enough; ``accuracy`` is what can be had, in metres, None for nothing."""

    def __init__(self, sentence: str, accuracy: float | None) -> None:
        super().__init__(sentence)
        self.accuracy = accuracy


Change = Callable[[FloatArray], FloatArray]


def crs_named(text: str) -> CRS:
    """The system of a code, a URN or the text of a .prj file. Raises ``ValueError``."""
    try:
        return CRS.from_user_input(text)
    except CRSError as error:
        msg = sentence("the coordinate system '{text}' is not known", text=" ".join(text.split())[:60])
        raise ValueError(msg) from error


def lonlat_from(system: CoordinateSystem | CRS, *, inexact: bool = False) -> Change:
    """What turns shape (N, 2), east and north or longitude and latitude of a system, into WGS 84 degrees of that order.

    Raises ``DatumError``, at once or on use, where the datum can only be changed within metres and ``inexact`` is not.
    """
    crs = _crs_of(system)
    if not _is_tokyo(crs):
        return functools.partial(_applied, _transformer(crs, inexact=inexact), "FORWARD")
    to_tokyo = Transformer.from_crs(crs, TOKYO_EPSG, always_xy=True)
    return lambda points: _from_tokyo(_applied(to_tokyo, "FORWARD", points), inexact=inexact)


def lonlat_to(system: CoordinateSystem | CRS, *, inexact: bool = False) -> Change:
    """The way back from WGS 84 degrees, with the same errors."""
    crs = _crs_of(system)
    if not _is_tokyo(crs):
        return functools.partial(_applied, _transformer(crs, inexact=inexact), "INVERSE")
    to_tokyo = Transformer.from_crs(crs, TOKYO_EPSG, always_xy=True)
    return lambda lonlat: _applied(to_tokyo, "INVERSE", _to_tokyo(lonlat, inexact=inexact))


def _crs_of(system: CoordinateSystem | CRS) -> CRS:
    return CRS.from_epsg(system.epsg) if isinstance(system, CoordinateSystem) else system


def _is_tokyo(crs: CRS) -> bool:
    geodetic = crs.geodetic_crs
    return geodetic is not None and geodetic.to_epsg(min_confidence=20) == TOKYO_EPSG


def _applied(transformer: Transformer, direction: str, points: FloatArray) -> FloatArray:
    pairs = np.asarray(points, dtype=float).reshape(-1, 2)
    return np.column_stack(transformer.transform(pairs[:, 0], pairs[:, 1], direction=direction))


def _transformer(crs: CRS, *, inexact: bool) -> Transformer:
    try:
        return Transformer.from_crs(crs, "EPSG:4326", always_xy=True, accuracy=EXACT, allow_ballpark=False)
    except ProjError as error:
        group = TransformerGroup(crs, "EPSG:4326", always_xy=True, allow_ballpark=False)
        if not group.transformers:
            msg = sentence(
                "'{name}' cannot be turned into WGS 84 within {exact:g} m here, nor any worse",
                name=crs.name,
                exact=EXACT,
            )
            raise DatumError(msg, None) from error
        if inexact:
            return group.transformers[0]
        accuracy = group.transformers[0].accuracy
        msg = sentence(
            "'{name}' cannot be turned into WGS 84 within {exact:g} m here, only within {accuracy:g} m",
            name=crs.name,
            exact=EXACT,
            accuracy=accuracy,
        )
        raise DatumError(msg, accuracy) from error


def _from_tokyo(points: FloatArray, *, inexact: bool) -> FloatArray:
    shift = _grid_shift(points)
    if shift is not None:
        return points + shift
    _accept_without_grid(inexact=inexact)
    rough = Transformer.from_crs(TOKYO_EPSG, "EPSG:4326", always_xy=True, allow_ballpark=False)
    return _applied(rough, "FORWARD", points)


def _to_tokyo(lonlat: FloatArray, *, inexact: bool) -> FloatArray:
    rough = Transformer.from_crs(TOKYO_EPSG, "EPSG:4326", always_xy=True, allow_ballpark=False)
    points = start = _applied(rough, "INVERSE", lonlat)
    for _ in range(TURNS_BACK):
        shift = _grid_shift(points)
        if shift is None:
            _accept_without_grid(inexact=inexact)
            return start
        points = np.asarray(lonlat, dtype=float).reshape(-1, 2) - shift
    return points


def _accept_without_grid(*, inexact: bool) -> None:
    if not inexact:
        msg = sentence(
            "the Tokyo datum cannot be turned into WGS 84 within {exact:g} m here, only within "
            "{reached:g} m: the grid of Japan is not installed (guidance-app[japan]) or ends before here",
            exact=EXACT,
            reached=TOKYO_WITHOUT_GRID,
        )
        raise DatumError(msg, TOKYO_WITHOUT_GRID)


def _grid_shift(points: FloatArray) -> FloatArray | None:
    """Degrees to add to Tokyo longitude and latitude; None without the package or where its grid has no cell."""
    bilinear = _grid()
    if bilinear is None or not np.all(np.isfinite(points)):
        return None
    shifts = []
    for longitude, latitude in points.tolist():
        north, east = bilinear(latitude, longitude)
        if north is None or east is None:
            return None
        shifts.append((east / ARCSECONDS, north / ARCSECONDS))
    return np.asarray(shifts, dtype=float).reshape(-1, 2)


@functools.cache
def _grid() -> Callable[[float, float], tuple[float | None, float | None]] | None:
    """The interpolation of the Geospatial Information Authority of Japan, its parameters read once (11 MB)."""
    try:
        package = importlib.import_module("tky2jgd")
    except ModuleNotFoundError:
        return None
    with importlib.resources.as_file(importlib.resources.files("tky2jgd") / "data" / "TKY2JGD.par") as path:
        package.load_parameter(path)
    bilinear: Callable[[float, float], tuple[float | None, float | None]] = package.bilinear
    return bilinear
