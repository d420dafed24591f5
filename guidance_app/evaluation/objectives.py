"""What a tuning of the four-state filter is judged by: simulated paths with their truth, or a user's own recordings.

**Simulated**: root mean square distance to the true path (equation 13 of Gomez-Gil et al. 2013), over the paper's 18
straight lines and over arcs, a U-turn and a meander. The lines alone are offered, for they are the paper's; but a
filter tuned on them alone forgets how to turn: it ends 1.3 to 2.2 m off an arc.

**Recorded**: no truth is known, so each estimate is carried on for a second and compared with the fix that then came.
A filter that follows the rounding points the wrong way, one that is too stiff leaves the curve; both show.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from guidance_app.evaluation.gomez_gil import Reading, differences, eighteen_lines, rounding_only
from guidance_app.evaluation.kernels import COLUMNS, IntArray, squared_error
from guidance_app.evaluation.scenarios import Purpose, generator, truth_of
from guidance_app.evaluation.signals import record
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import FloatArray

__all__ = ["Objective", "TuningError", "mixed_objective", "recorded_objective", "straight_objective"]

FIXES_PER_LINE = 100
TURNING = ("arc50", "arc15", "uturn", "meander")

HORIZON = 1.0
"""A recorded estimate is judged by where it says that the tractor is after so many seconds."""
LONGEST_GAP = 2.0
SHORTEST_PIECE = 15.0
SHARE = 60.0
"""Seconds of a piece that are kept together in the cross-validation."""
SLOW = 0.3
LEAST_DISTANCE = 100.0
LEAST_SECONDS = 60.0


class TuningError(Exception):
    """Why these recordings cannot tune a filter."""


@dataclass(frozen=True, slots=True, eq=False)
class Objective:
    """Epochs of several pieces, as ``kernels`` takes them, and what each piece is called."""

    table: FloatArray
    starts: IntArray
    names: tuple[str, ...]

    @property
    def count(self) -> float:
        """How many epochs are judged."""
        return float(self.table[:, COLUMNS.index("weight")].sum())

    def rms(self, noise: FloatArray) -> float:
        """Root mean square distance in metres with these diagonals of Q, R and P0 (12 numbers)."""
        return math.sqrt(squared_error(self.table, self.starts, noise, math.inf) / self.count)

    def only(self, *names: str) -> "Objective":
        """The pieces of these names alone."""
        return self.picked([number for number, name in enumerate(self.names) if name in names])

    def hardest_first(self, noise: FloatArray) -> "Objective":
        """The same pieces, those with the largest errors first, so that a losing draw is dropped early."""
        errors = [self.picked([number]).rms(noise) for number in range(len(self.names))]
        return self.picked(sorted(range(len(errors)), key=lambda number: -errors[number]))

    def picked(self, numbers: Sequence[int]) -> "Objective":
        """The pieces of these numbers alone."""
        pieces = [self.table[self.starts[number] : self.starts[number + 1]] for number in numbers]
        return _joined(pieces, [self.names[number] for number in numbers])


def straight_objective(fixes: int = FIXES_PER_LINE) -> Objective:
    """The paper's own: 18 straight lines at 5 km/h and nothing else."""
    pieces = [_simulated(rounding_only(line), line) for line in eighteen_lines(fixes)]
    return _joined(pieces, ["lines"] * len(pieces))


def mixed_objective() -> Objective:
    """The 18 lines and four paths that turn, drawn from the tuning seeds.

    The turning ones come first: there most draws fail, so that they are dropped early.
    """
    pieces, names = [], []
    for name in TURNING:
        random = generator(Purpose.TUNING, name, 0)
        truth = truth_of(name, random)
        pieces.append(_simulated(record(truth, random), truth))
        names.append(name)
    lines = straight_objective()
    pieces += [lines.table[lines.starts[k] : lines.starts[k + 1]] for k in range(len(lines.names))]
    return _joined(pieces, [*names, *lines.names])


def recorded_objective(recordings: Sequence[Recording]) -> Objective:
    """Recorded drives, cut at gaps; standing epochs do not count.

    Raises :class:`TuningError` with the reason when too little of them moves.
    """
    pieces = [piece for recording in recordings for piece in _pieces(recording)]
    seconds = sum(float(piece[piece[:, COLUMNS.index("weight")] > 0, 0].sum()) for piece in pieces)
    distance = sum(float((piece[:, 0] * piece[:, 4])[piece[:, COLUMNS.index("weight")] > 0].sum()) for piece in pieces)
    if not any(len(recording) > 1 for recording in recordings):
        msg = "no recording holds two fixes: there is nothing to tune on"
        raise TuningError(msg)
    longest = max(float(recording.t[-1] - recording.t[0]) for recording in recordings if len(recording) > 1)
    if longest < LEAST_SECONDS:
        msg = (
            f"the recording is too short: {longest:.0f} s; at least {LEAST_SECONDS:.0f} s and"
            f" {LEAST_DISTANCE:.0f} m of driving are needed"
        )
        raise TuningError(msg)
    if seconds < LEAST_SECONDS or distance < LEAST_DISTANCE:
        msg = (
            f"the recording stands still too much: it moves for {seconds:.0f} s and {distance:.0f} m;"
            f" at least {LEAST_SECONDS:.0f} s and {LEAST_DISTANCE:.0f} m of driving are needed"
        )
        raise TuningError(msg)
    return _joined(pieces, [f"piece {number + 1}" for number in range(len(pieces))])


def _joined(pieces: Sequence[FloatArray], names: Sequence[str]) -> Objective:
    lengths = [len(piece) for piece in pieces]
    starts = np.concatenate(([0], np.cumsum(lengths))).astype(np.int64)
    return Objective(np.concatenate(pieces), starts, tuple(names))


def _table(recording: Recording, velocity: FloatArray) -> FloatArray:
    """The epochs of one recording; targets and weights are left at zero."""
    table = np.zeros((len(recording), len(COLUMNS)))
    table[1:, 0] = np.diff(recording.t)
    table[:, 1:3] = recording.position
    table[:, 3] = _held_course(velocity)
    table[:, 4] = np.hypot(velocity[:, 0], velocity[:, 1])
    return table


def _held_course(velocity: FloatArray) -> FloatArray:
    """Shape (N,): direction of motion; where nothing moved, that of the sample before (or of the first that moved)."""
    moved = np.hypot(velocity[:, 0], velocity[:, 1]) > 0
    if not moved.any():
        return np.zeros(len(velocity))
    last = np.maximum.accumulate(np.where(moved, np.arange(len(velocity)), -1))
    last = np.where(last < 0, int(np.argmax(moved)), last)
    course: FloatArray = np.arctan2(velocity[last, 0], velocity[last, 1])
    return course


def _simulated(recording: Recording, truth: Track) -> FloatArray:
    """A piece that is judged by its truth at once."""
    interval = float(truth.t[1] - truth.t[0])
    table = _table(recording, differences(recording.position, interval, Reading.TWO_STEP))
    table[:, 5:7] = truth.positions
    table[:, 8] = 1.0
    return table


def _pieces(recording: Recording) -> list[FloatArray]:
    """A recorded drive without its gaps, each piece judged by the fix that came a second later."""
    if len(recording) < 2:
        return []
    gaps = np.flatnonzero(np.diff(recording.t) > LONGEST_GAP) + 1
    tables = []
    for rows in _shares(np.split(np.arange(len(recording)), gaps), recording.t):
        t = recording.t[rows]
        if t[-1] - t[0] < SHORTEST_PIECE or len(rows) < 5:
            continue
        part = Recording(t, recording.position[rows], recording.cell)
        velocity = _recorded_velocity(recording, rows, t)
        table = _table(part, velocity)
        later = np.searchsorted(t, t + HORIZON - 1e-6)
        known = later < len(rows)
        target = np.minimum(later, len(rows) - 1)
        table[:, 5:7] = part.position[target]
        table[:, 7] = t[target] - t
        settled = t - t[0] > 5.0
        table[:, 8] = np.where(known & settled & (table[:, 4] > SLOW), 1.0, 0.0)
        tables.append(table)
    return tables


def _shares(stretches: Sequence[IntArray], t: FloatArray) -> Iterator[IntArray]:
    """The stretches cut into shares of about a minute, so that some can be kept from the tuning."""
    for rows in stretches:
        count = max(1, int((t[rows[-1]] - t[rows[0]]) // SHARE))
        yield from np.array_split(rows, count)


def _recorded_velocity(recording: Recording, rows: IntArray, t: FloatArray) -> FloatArray:
    """The receiver's own, else from fixes two steps apart, as the console's filter does."""
    if recording.velocity is not None:
        return recording.velocity[rows]
    position = recording.position[rows]
    steps = (position[2:] - position[:-2]) / (t[2:] - t[:-2])[:, None]
    return np.concatenate([np.repeat(steps[:1], 2, axis=0), steps])
