"""The roll sensor's zero, from driving one line there and back.

A roll sensor that shows r too much to the right puts the ground point h sin(r) too far left; on the way back too far
left again, which is the other side of the line. Half the gap between the two recorded tracks over the antenna's height
is therefore the error. An antenna that sits beside where the document says does the same, and the two
cannot be told apart by driving: measure the antenna first.
"""

import math
from dataclasses import dataclass

import numpy as np

from guidance_app.angles import wrap_pi
from guidance_app.language import sentence
from guidance_app.model import FloatArray, Pose

__all__ = ["SHORTEST", "CalibrationError", "RollZero", "roll_zero"]

SHORTEST = 30.0
"""A shared stretch shorter than this many metres does not average the steering out."""
OPPOSITE = math.radians(10)
LARGEST = math.radians(10)
BIN = 1.0


class CalibrationError(Exception):
    """The two drives cannot be compared; the sentence says why and what to do."""


@dataclass(frozen=True, slots=True)
class RollZero:
    """What to add to the tractor's roll zero, in degrees, how sure it is, and over how many metres it was found."""

    correction_deg: float
    sigma_deg: float
    metres: float


def roll_zero(there: list[Pose], back: list[Pose], antenna_height: float) -> RollZero:
    """The roll sensor's zero error from the same line driven there and back, as the filter saw it.

    Raises ``CalibrationError`` for drives that are not opposite, share less than 30 m, or differ by an angle that no
    mounting has.
    """
    if antenna_height < 0.5:
        msg = sentence(
            "an antenna {height:g} m above the ground hardly moves with the roll: nothing to calibrate",
            height=antenna_height,
        )
        raise CalibrationError(msg)
    out, home = _track(there), _track(back)
    direction = _direction(out)
    turned = wrap_pi(_direction(home) - direction)
    if abs(abs(turned) - math.pi) > OPPOSITE:
        msg = sentence(
            "the second drive runs {angle:.0f} degrees to the first: drive the same line back",
            angle=abs(math.degrees(turned)),
        )
        raise CalibrationError(msg)
    gaps = _gaps(out, home, direction)
    metres = len(gaps) * BIN
    if metres < SHORTEST:
        msg = sentence("the two drives share {metres:.0f} m; {needed:.0f} m are needed", metres=metres, needed=SHORTEST)
        raise CalibrationError(msg)
    # each track lies to its own left by h sin(error): the second, seen from the first, to the right
    shift = 0.5 * float(np.mean(gaps))
    if abs(shift) > antenna_height * math.sin(LARGEST):
        msg = sentence("the two drives lie {apart:.2f} m apart: drive in the same wheel tracks", apart=2 * abs(shift))
        raise CalibrationError(msg)
    independent = max(metres / 10.0, 1.0)  # a driver's correction lasts about ten metres
    scatter = 0.5 * float(np.std(gaps)) / math.sqrt(independent)
    angle = math.asin(shift / antenna_height)
    return RollZero(math.degrees(angle), math.degrees(scatter / antenna_height), metres)


def _track(poses: list[Pose]) -> FloatArray:
    """Shape (N, 2): east, north, of the moving forward part."""
    points = [(p.east, p.north) for p in poses if p.heading_known and not p.standing and p.speed > 0.0]
    if len(points) < 10:
        msg = sentence("a drive holds hardly any fix of a moving tractor")
        raise CalibrationError(msg)
    return np.array(points)


def _direction(track: FloatArray) -> float:
    """Heading from the track's first to its last point."""
    way = track[-1] - track[0]
    return math.atan2(way[0], way[1])


def _gaps(out: FloatArray, home: FloatArray, direction: float) -> FloatArray:
    """Shape (M,): by how much the second track lies right of the first, metre by metre where both were."""
    along = np.array([math.sin(direction), math.cos(direction)])
    right = np.array([math.cos(direction), -math.sin(direction)])
    first, second = (_binned(track @ along, track @ right) for track in (out, home))
    shared = sorted(first.keys() & second.keys())
    return np.array([second[at] - first[at] for at in shared])


def _binned(along: FloatArray, right: FloatArray) -> dict[int, float]:
    """Mean distance to the right in each metre along."""
    places = np.floor(along / BIN).astype(int)
    return {int(at): float(right[places == at].mean()) for at in np.unique(places)}
