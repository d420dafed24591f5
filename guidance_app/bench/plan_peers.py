"""Other planners beside ours, where their wheels are installed (the extra ``peers``).

``coverage-path-planner`` (C++, mowing robots) knows no turning radius: it pivots. ``covplan`` (Hameed et al. 2013)
turns on Dubins curves and never works the headland. Fields2Cover 2.1.0 has no wheel, and its source distribution does
not build by itself: while it is built it fetches OR-Tools 9.9, steering_functions and Matplot++ from where they are
developed, and no package of the three stands in for them. Its figures are those of the literature row in ``plan``.
"""

import contextlib
import importlib
import importlib.util
import io
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from guidance_app.bench.plan_cases import outside
from guidance_app.geodesy import FieldFrame
from guidance_app.model import FloatArray

__all__ = ["PeerCase", "installed", "peer_case"]

FRAME = FieldFrame(48.0, 11.0)
"""Where a polygon in metres is put for a planner that wants degrees."""

CLUSTERS = 4
"""Parts into which covplan divides a field, as in its own example."""

Planner = Callable[[shapely.Polygon, float, float, int], FloatArray]


@dataclass(frozen=True, slots=True)
class PeerCase:
    """What another planner's path comes to; ``failed`` says why there is none."""

    worked: float = 0.0
    outside: int = 0
    cpu_s: float = 0.0
    failed: str = ""


def installed() -> dict[str, Planner]:
    """The planners that can be imported here, by the name of their distribution."""
    known: dict[str, tuple[str, Planner]] = {
        "coverage-path-planner": ("coverage_path_planner", _mowing_robot),
        "covplan": ("covplan", _covplan),
    }
    return {name: planner for name, (module, planner) in known.items() if importlib.util.find_spec(module)}


def peer_case(planner: Planner, polygon: shapely.Polygon, width: float, radius: float, laps: int) -> PeerCase:
    """One field planned by another planner with as deep a headland."""
    begin = time.process_time()
    try:
        points = planner(polygon, width, radius, laps)
    except Exception as error:  # noqa: BLE001 - whatever a foreign planner raises is its result here
        return PeerCase(failed=f"{type(error).__name__}: {error}")
    seconds = time.process_time() - begin
    if len(points) < 2:
        return PeerCase(failed="an empty path")
    line = shapely.LineString(points)
    swath = line.buffer(width / 2, cap_style="flat", join_style="mitre")
    return PeerCase(swath.intersection(polygon).area / polygon.area, outside(line, polygon), seconds)


def _mowing_robot(polygon: shapely.Polygon, width: float, radius: float, laps: int) -> FloatArray:
    del radius
    planner = importlib.import_module("coverage_path_planner")

    def ring(line: shapely.LinearRing) -> object:
        return planner.Polygon([planner.Point(east, north) for east, north in shapely.get_coordinates(line)[:-1]])

    field = planner.Environment(ring(polygon.exterior))
    for hole in polygon.interiors:
        field.addObstacle(ring(hole))
    settings = planner.PathSettings()
    settings.pattern, settings.offset, settings.angle = "lines", width, 0.0
    settings.distanceToBorder = width / 2
    settings.mowArea = settings.mowBorder = settings.mowExclusionsBorder = True
    settings.borderLaps = settings.exclusionsBorderLaps = laps
    start = planner.Point(*polygon.exterior.coords[0])
    path = planner.PathService().computeFullTask(field, settings, start).path.getPoints()
    return np.array([(point.x, point.y) for point in path]).reshape(-1, 2)


def _covplan(polygon: shapely.Polygon, width: float, radius: float, laps: int) -> FloatArray:
    planner = importlib.import_module("covplan")
    oriented = shapely.orient_polygons(polygon, exterior_cw=True)
    lines: list[str] = []
    for ring in (oriented.exterior, *oriented.interiors):
        lonlat = FRAME.lonlat_from_array(shapely.get_coordinates(ring))
        lines += [f"{latitude:.9f} {longitude:.9f}" for longitude, latitude in lonlat] + ["NaN NaN"]
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        file = Path(folder) / "field.txt"
        file.write_text("\n".join(lines) + "\n", encoding="ascii")
        path = planner.pathplan(
            str(file), width=width, num_hd=2 * laps, theta=0, num_clusters=CLUSTERS, radius=radius, visualize=False
        )
    latlon = np.array(path).reshape(-1, 2)
    return FRAME.array_from_lonlat(latlon[:, ::-1])
