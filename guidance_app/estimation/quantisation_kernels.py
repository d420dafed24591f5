"""The arithmetic of ``quantisation_kf``, one epoch or a whole track of them, compiled by numba.

The filter in the cab calls ``advance`` for each fix, an evaluation calls ``filtered`` for a whole recording; both are
the same step on the same memory. Equations: Gomez-Gil et al., Sensors 13 (2013).
"""

import math

import numba
import numpy as np

from guidance_app.estimation import reference_point
from guidance_app.estimation.observation_kernels import NO_COURSE
from guidance_app.estimation.travel_kernels import REVERSE, TRAVEL, nothing_driven, travelled, wrap_2pi, wrap_pi
from guidance_app.model import FloatArray

__all__ = ["advance", "correct", "filtered", "nothing_seen", "predict"]

LONGEST_GAP = 5.0
STANDING = 0.1
CREEPING = 0.15
INNOVATION_MEMORY = 0.1
"""Weight of the newest innovation in the running scale of the covariance."""
NO_SPEED = -1.0

Z_T, Z_EAST, Z_NORTH, Z_SPEED, Z_COURSE, Z_COMPASS, ARM_FORWARD, ARM_RIGHT, FIX_EE, FIX_EN, FIX_NN = range(11)
"""An epoch: time, position, speed (or ``NO_SPEED``), course and heading sensor (or ``NO_COURSE``), lever arm, and what
the fix alone says of the position: var east, cov, var north."""
EPOCH = 11

EAST, NORTH, HEADING, SPEED, EE, EN, ES, NN, NS, SS, HH = range(11)
"""The filter's state: its mean, the covariance of east, north and speed, and the heading's variance."""
T, COURSE, SCALE, RUNNING, SEEN, FIRST, SECOND, WAY = 11, 12, 13, 14, 15, 16, 19, 22
"""The rest of the memory: time of the last epoch, last course, running ratio of the innovations to what the covariance
foresaw, whether there is a state, how many fixes there were (2 at most), the last two (time, east, north), and the way
that ``travel_kernels`` remember."""
MEMORY = WAY + TRAVEL

P_EAST, P_NORTH, P_HEADING, P_SPEED, P_EE, P_EN, P_NN, P_KNOWN, P_STANDING, P_REVERSE = range(10)
"""A pose. The last three are 0 or 1."""
POSE = 10

offset_point = numba.njit(cache=True)(reference_point.offset_point)


@numba.njit(cache=True)
def nothing_seen() -> FloatArray:
    """The memory before the first fix."""
    memory = np.zeros(MEMORY)
    _forget(memory)
    return memory


@numba.njit(cache=True)
def filtered(epochs: FloatArray, noise: FloatArray) -> FloatArray:
    """Shape (N, 10): the poses at all ``epochs`` (N, 11), each known from those before it alone."""
    memory = nothing_seen()
    poses = np.empty((len(epochs), POSE))
    for k in range(len(epochs)):
        advance(memory, epochs[k], noise, poses[k])
    return poses


@numba.njit(cache=True)
def advance(memory: FloatArray, z: FloatArray, noise: FloatArray, pose: FloatArray) -> None:
    """One epoch: ``memory`` and ``pose`` are changed in place. The epoch must be later than the memory's last.

    ``noise`` holds the diagonals of Q, R and P0 (12 numbers) in the order east, north, heading, speed.
    """
    if z[Z_T] - memory[T] > LONGEST_GAP:
        _forget(memory)
    travelled(memory[WAY:], z[Z_EAST], z[Z_NORTH], z[Z_COMPASS])
    reverse = memory[WAY + REVERSE] == 1.0
    heading, speed = _course_and_speed(memory, z, reverse)
    memory[COURSE] = heading
    if heading != NO_COURSE:
        _next_state(memory, z, heading, speed, noise)
    memory[T] = z[Z_T]
    memory[FIRST : FIRST + 3] = memory[SECOND : SECOND + 3]
    memory[SECOND : SECOND + 3] = z[Z_T : Z_NORTH + 1]
    memory[SEEN] = min(memory[SEEN] + 1.0, 2.0)
    _show(memory, z, pose)
    pose[P_REVERSE] = reverse


@numba.njit(cache=True)
def _forget(memory: FloatArray) -> None:
    memory[:WAY] = 0.0
    memory[T] = -math.inf
    memory[COURSE] = NO_COURSE
    memory[SCALE] = 1.0
    memory[WAY:] = nothing_driven()


@numba.njit(cache=True)
def _course_and_speed(memory: FloatArray, z: FloatArray, reverse: bool) -> tuple[float, float]:
    """The derived measurements: heading of the body, ``NO_COURSE`` before there is any, and speed, negative in reverse.

    Slower than ``CREEPING`` a course is noise; the last one stays.
    """
    heading = memory[COURSE]
    if z[Z_SPEED] != NO_SPEED:
        speed = z[Z_SPEED]
        course = z[Z_COURSE]
    elif memory[SEEN] == 2.0:
        east, north = z[Z_EAST] - memory[FIRST + 1], z[Z_NORTH] - memory[FIRST + 2]
        speed = math.hypot(east, north) / (z[Z_T] - memory[FIRST])
        course = math.atan2(east, north)
    else:
        return NO_COURSE, 0.0
    if course != NO_COURSE and speed >= CREEPING:
        heading = wrap_pi(course + math.pi) if reverse else course
    if z[Z_COMPASS] != NO_COURSE:
        heading = z[Z_COMPASS]
    return heading, -speed if reverse else speed


@numba.njit(cache=True)
def _next_state(memory: FloatArray, z: FloatArray, heading: float, speed: float, noise: FloatArray) -> None:
    """The new state and scale, in place."""
    q, r, p0 = noise[:4], noise[4:8], noise[8:]
    if memory[RUNNING] == 0.0:
        memory[EAST], memory[NORTH], memory[HEADING], memory[SPEED] = z[Z_EAST], z[Z_NORTH], heading, speed
        memory[EE], memory[NN], memory[HH], memory[SS] = p0[0], p0[1], p0[2], p0[3]
        memory[RUNNING] = 1.0
        return
    predict(memory, z[Z_T] - memory[T], q)
    east, north = z[Z_EAST] - memory[EAST], z[Z_NORTH] - memory[NORTH]
    ratio = east * east / (memory[EE] + r[0]) + north * north / (memory[NN] + r[1])
    memory[SCALE] += INNOVATION_MEMORY * (0.5 * ratio - memory[SCALE])
    correct(memory, (z[Z_EAST], z[Z_NORTH], heading, speed), r)


@numba.njit(cache=True)
def predict(s: FloatArray, dt: float, q: FloatArray) -> None:
    """Eqs 4 to 9, in place: straight on. P = F P F' + Q with a = dt sin(heading), b = dt cos(heading) in F."""
    a, b = dt * math.sin(s[HEADING]), dt * math.cos(s[HEADING])
    s[EAST] += a * s[SPEED]
    s[NORTH] += b * s[SPEED]
    s[EE] += a * (2.0 * s[ES] + a * s[SS]) + q[0]
    s[NN] += b * (2.0 * s[NS] + b * s[SS]) + q[1]
    s[EN] += b * s[ES] + a * s[NS] + a * b * s[SS]
    s[ES] += a * s[SS]
    s[NS] += b * s[SS]
    s[SS] += q[3]
    s[HH] += q[2]


@numba.njit(cache=True)
def correct(s: FloatArray, z: tuple[float, float, float, float], r: FloatArray) -> None:
    """Eq. 10 with H = I, in place, one component after the other, which is the same because R is diagonal."""
    ee, en, es, nn, ns, ss = s[EE], s[EN], s[ES], s[NN], s[NS], s[SS]

    ke, kn, ks = ee / (ee + r[0]), en / (ee + r[0]), es / (ee + r[0])
    innovation = z[0] - s[EAST]
    s[EAST], s[NORTH], s[SPEED] = s[EAST] + ke * innovation, s[NORTH] + kn * innovation, s[SPEED] + ks * innovation
    nn, ns, ss = nn - kn * en, ns - kn * es, ss - ks * es
    ee, en, es = ee - ke * ee, en - ke * en, es - ke * es

    ke, kn, ks = en / (nn + r[1]), nn / (nn + r[1]), ns / (nn + r[1])
    innovation = z[1] - s[NORTH]
    s[EAST], s[NORTH], s[SPEED] = s[EAST] + ke * innovation, s[NORTH] + kn * innovation, s[SPEED] + ks * innovation
    ee, es, ss = ee - ke * en, es - ke * ns, ss - ks * ns
    en, nn, ns = en - kn * en, nn - kn * nn, ns - kn * ns

    ke, kn, ks = es / (ss + r[3]), ns / (ss + r[3]), ss / (ss + r[3])
    innovation = z[3] - s[SPEED]
    s[EAST], s[NORTH], s[SPEED] = s[EAST] + ke * innovation, s[NORTH] + kn * innovation, s[SPEED] + ks * innovation
    ee, en, nn = ee - ke * es, en - ke * ns, nn - kn * ns
    es, ns, ss = es - ks * es, ns - ks * ns, ss - ks * ss

    s[EE], s[EN], s[ES], s[NN], s[NS], s[SS] = ee, en, es, nn, ns, ss
    gain = s[HH] / (s[HH] + r[2])
    s[HEADING] = wrap_pi(s[HEADING] + gain * wrap_pi(z[2] - s[HEADING]))
    s[HH] = (1.0 - gain) * s[HH]


@numba.njit(cache=True)
def _show(memory: FloatArray, z: FloatArray, pose: FloatArray) -> None:
    """The state as a pose of the reference point, in place; before there is a state it is the fix itself."""
    pose[:] = 0.0
    if memory[RUNNING] == 0.0:
        pose[P_EAST], pose[P_NORTH] = z[Z_EAST], z[Z_NORTH]
        pose[P_EE], pose[P_EN], pose[P_NN] = z[FIX_EE], z[FIX_EN], z[FIX_NN]
        return
    pose[P_EAST], pose[P_NORTH] = offset_point(
        memory[EAST], memory[NORTH], memory[HEADING], -z[ARM_FORWARD], -z[ARM_RIGHT]
    )
    pose[P_HEADING], pose[P_SPEED] = wrap_2pi(memory[HEADING]), memory[SPEED]
    pose[P_EE] = memory[SCALE] * memory[EE] + 0.25 * z[FIX_EE]
    pose[P_EN] = memory[SCALE] * memory[EN]
    pose[P_NN] = memory[SCALE] * memory[NN] + 0.25 * z[FIX_NN]
    pose[P_KNOWN] = 1.0
    pose[P_STANDING] = abs(memory[SPEED]) < STANDING
