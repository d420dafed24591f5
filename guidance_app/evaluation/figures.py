"""The papers' figures, redrawn from our runs: Gomez-Gil et al. 10 to 13, Inoue et al. 8, 9, 13 and 14.

Each is written as PNG and as SVG. Those that need a real recording (10b and 13) are drawn only where there is one.
Matplotlib is an extra.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.gomez_gil import (
    SIXTY_FROM_EAST,
    Reading,
    adaptive_filter,
    eighteen_lines,
    heading_runs,
    paper_filter,
    rounding_only,
    unfiltered,
)
from guidance_app.evaluation.inoue import field_run
from guidance_app.evaluation.metrics import errors_of, wrapped
from guidance_app.evaluation.real import as_courses, chord_headings, frame_of, recording_from_fixes
from guidance_app.evaluation.scenarios import KMH, Purpose, generator, straight_line
from guidance_app.evaluation.signals import gauss_markov
from guidance_app.evaluation.steering import Steering, simulate
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.model import Fix, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FiguresMissingError", "draw_figures"]

BEFORE, PAPER, OURS, TRUE = "#b5651d", "#3b6ea5", "#1b7837", "#444444"
SHOWN = slice(60, 90)
"""Fixes of a path that are shown large."""

SCREEN_SIGMA, SCREEN_TIME = 0.06, 6.0
"""By how many metres, and for how many seconds, the screen is off while the driver steers by it."""


class FiguresMissingError(Exception):
    """Matplotlib is not installed."""


def draw_figures(folder: Path, fixes: Sequence[Fix] | None) -> list[Path]:
    """Writes all figures into ``folder`` and gives their paths; ``fixes`` is a real recording of a tractor, if any.

    Raises :class:`FiguresMissingError` without matplotlib, ``OSError`` when the folder cannot be written.
    """
    try:
        from matplotlib.figure import Figure  # noqa: PLC0415 - an extra
    except ModuleNotFoundError as error:
        msg = "figures need matplotlib; pip install 'guidance-app[figures]'"
        raise FiguresMissingError(msg) from error
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, draw in FIGURES.items():
        figure = Figure(figsize=(9, 5), layout="constrained")
        draw(figure)
        written += _saved(figure, folder, name)
    if fixes:
        for name, draw_real in REAL_FIGURES.items():
            figure = Figure(figsize=(9, 5), layout="constrained")
            draw_real(figure, fixes)
            written += _saved(figure, folder, name)
    return written


def _saved(figure: "Figure", folder: Path, name: str) -> list[Path]:
    paths = [folder / f"{name}.{kind}" for kind in ("png", "svg")]
    for path in paths:
        figure.savefig(path, dpi=150)
    return paths


# --- Gomez-Gil et al. ----------------------------------------------------------------------------------------------


def _path_at_sixty(figure: "Figure") -> None:
    truth = straight_line(SIXTY_FROM_EAST, 5 * KMH, 250)
    raw = rounding_only(truth)
    axes = _axes(figure, "Figure 10a: straight path at 60°, 5 km/h, 5 Hz", "east, m", "north, m")
    axes.plot(truth.east[SHOWN], truth.north[SHOWN], color=TRUE, linewidth=1, label="true path")
    axes.plot(*raw.position[SHOWN].T, "s-", color=BEFORE, markersize=3, linewidth=0.7, label="before filtering")
    filtered = paper_filter(rounding_only(truth, Reading.TWO_STEP))
    axes.plot(filtered.east[SHOWN], filtered.north[SHOWN], ".-", color=PAPER, label="paper's filter")
    ours = adaptive_filter(raw)
    axes.plot(ours.east[SHOWN], ours.north[SHOWN], ".-", color=OURS, label="adaptive filter")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend()


def _distance_histograms(figure: "Figure") -> None:
    lines = eighteen_lines()
    cases: Mapping[str, tuple[Callable[[Recording], Track], Reading | None, str]] = {
        "before filtering": (unfiltered, None, BEFORE),
        "paper's filter": (paper_filter, Reading.TWO_STEP, PAPER),
        "adaptive filter": (adaptive_filter, None, OURS),
    }
    panels = figure.subplots(1, len(cases), sharex=True, sharey=True)
    for axes, (title, (filtering, reading, colour)) in zip(panels, cases.items(), strict=True):
        parts = [errors_of(filtering(rounding_only(line, reading)), line).distance for line in lines]
        axes.hist(100 * np.concatenate(parts), bins=np.arange(0, 15.1, 0.5), density=True, color=colour)
        axes.set_title(title)
        axes.set_xlabel("distance error, cm")
    panels[0].set_ylabel("density, 1/cm")
    figure.suptitle("Figure 11: distance errors over the 18 straight lines")


def _heading_histograms(figure: "Figure") -> None:
    def courses(filtering: Callable[[Recording], Track], reading: Reading | None) -> FloatArray:
        parts = []
        for truth in heading_runs():
            step = np.diff(filtering(rounding_only(truth, reading)).positions, axis=0)
            parts.append(wrapped(np.arctan2(step[:, 0], step[:, 1]) - SIXTY_FROM_EAST))
        return np.concatenate(parts)

    state = np.concatenate([adaptive_filter(rounding_only(truth)).heading[15:] for truth in heading_runs()])
    _heading_panels(
        figure,
        "Figure 12: heading at 60°, 5 to 10 km/h, simulated",
        {
            "grid-quantised": (courses(unfiltered, None), BEFORE),
            "paper's filter, course of its track": (courses(paper_filter, Reading.TWO_STEP), PAPER),
            "adaptive filter, its heading": (wrapped(state - SIXTY_FROM_EAST), OURS),
        },
    )


def _heading_panels(figure: "Figure", title: str, panels: Mapping[str, tuple[FloatArray, str]]) -> None:
    """Histograms of heading errors (radians) beside each other."""
    bins = np.arange(-30, 30.1, 1.0).tolist()
    for axes, (name, (error, colour)) in zip(figure.subplots(1, len(panels), sharex=True), panels.items(), strict=True):
        axes.hist(np.clip(np.degrees(error), -30, 30), bins=bins, density=True, color=colour)
        axes.axvline(0, color=TRUE, linewidth=1)
        axes.set_title(f"{name}\nstd {np.degrees(np.std(error)):.2f}°", fontsize=9)
        axes.set_xlabel("heading less true heading, °")
    figure.suptitle(title)


def _real_path(figure: "Figure", fixes: Sequence[Fix]) -> None:
    frame, recording, straight = _straight_stretch(fixes)
    axes = _axes(figure, "Figure 10b: a straight stretch of a real recording, 1 Hz", "east, m", "north, m")
    axes.plot(*recording.position[straight].T, "s-", color=BEFORE, markersize=3, linewidth=0.7, label="as recorded")
    for name, colour, title in (("quantisation_kf", PAPER, "paper's filter"), ("adaptive", OURS, "adaptive filter")):
        track = estimate_recording(recording, name)
        shown = (track.t >= recording.t[straight][0]) & (track.t <= recording.t[straight][-1])
        axes.plot(track.east[shown], track.north[shown], ".-", color=colour, label=title)
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(title=f"origin {frame.latitude_deg:.4f}, {frame.longitude_deg:.4f}")


def _real_headings(figure: "Figure", fixes: Sequence[Fix]) -> None:
    frame, recording, _ = _straight_stretch(fixes)
    chords = chord_headings(fixes, frame)
    panels = {}
    raw = unfiltered(recording)
    panels["as recorded"] = (errors_of(raw, chords), BEFORE)
    for title, name, colour in (
        ("paper's filter", "quantisation_kf", PAPER),
        ("adaptive filter", "adaptive", OURS),
    ):
        panels[f"{title}, its heading"] = (errors_of(as_courses(estimate_recording(recording, name)), chords), colour)
    _heading_panels(
        figure,
        "Figure 13: headings of a real recording on straight stretches, against the chord of 8 s",
        {name: (errors.heading[errors.scored], colour) for name, (errors, colour) in panels.items()},
    )


def _straight_stretch(fixes: Sequence[Fix]) -> tuple[Any, Recording, slice]:
    """The field frame, the recording without velocity, and the longest straight stretch of at most 60 fixes."""
    frame = frame_of(fixes)
    known = chord_headings(fixes, frame).heading_known
    ends = np.flatnonzero(~known)
    edges = np.concatenate(([-1], ends, [len(known)]))
    longest = int(np.argmax(np.diff(edges)))
    first = int(edges[longest]) + 1
    recording = recording_from_fixes(fixes, frame, with_velocity=False)
    return frame, recording, slice(first, min(first + 60, int(edges[longest + 1])))


# --- Inoue et al. --------------------------------------------------------------------------------------------------


def _field_tracks(figure: "Figure") -> None:
    run = field_run(0)
    axes = _axes(figure, "Figure 8: DGPS, filtered and true track (simulated)", "east, m", "north, m")
    axes.plot(*run.recording.position.T, color=BEFORE, linewidth=0.8, label="DGPS")
    for name, colour in (("gyro_ekf", PAPER), ("adaptive", OURS)):
        track = estimate_recording(run.recording, name)
        axes.plot(track.east, track.north, color=colour, linewidth=1, label=name)
    axes.plot(run.truth.east, run.truth.north, color=TRUE, linewidth=0.8, label="true (RTK)")
    axes.legend()


def _field_errors(figure: "Figure") -> None:
    run = field_run(0)
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    driven = np.concatenate(([0.0], np.cumsum(run.truth.speed[:-1] * np.diff(run.truth.t))))
    for number, axes in enumerate(panels):
        for name, colour in (("off", BEFORE), ("gyro_ekf", PAPER), ("adaptive", OURS)):
            errors = errors_of(estimate_recording(run.recording, name), run.truth)
            row = np.searchsorted(run.truth.t, errors.t)
            shown = run.passes[row] == number
            axes.plot(driven[row][shown] - driven[row][shown][0], 100 * errors.right[shown], color=colour, label=name)
        axes.set_title(f"pass {number + 1}")
        axes.set_ylabel("error across, cm")
    panels[-1].set_xlabel("distance along the pass, m")
    panels[0].legend()
    figure.suptitle("Figure 9: error of DGPS and of the filters across the direction of travel (simulated)")


def _convergence(figure: "Figure") -> None:
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, speed in zip(panels, (1.0, 1.5), strict=True):
        for prediction, colour in ((0.5, BEFORE), (1.5, OURS), (2.5, PAPER)):
            run = simulate(speed, Steering(prediction), generator(Purpose.REPORT, "figure 13", 0))
            axes.plot(run.along, 100 * run.cross_track, color=colour, label=f"{prediction:g} s ahead")
        axes.axhline(0, color=TRUE, linewidth=0.8)
        axes.set_title(f"{speed:g} m/s")
        axes.set_xlabel("distance along the line, m")
    panels[0].set_ylabel("cross-track, cm")
    panels[0].legend()
    figure.suptitle("Figure 13: steering to the line from 1 m beside it, 8 % noise")


def _round_trip(figure: "Figure") -> None:
    axes = _axes(
        figure,
        "Figure 14: five passes of 160 m by the screen, looking 0.5 s (1, 2) and 1.5 s ahead (3 to 5), simulated",
        "distance along the pass, m",
        "deviation, cm (each pass on its own line)",
    )
    short, long = Steering(0.5, convergence=1.0), Steering(1.5)
    for number in range(5):
        random = generator(Purpose.REPORT, "figure 14", number)
        shown_off = gauss_markov(1340, 0.1, SCREEN_SIGMA, SCREEN_TIME, random)[:, 0]
        how = short if number < 2 else long
        run = simulate(1.2, how, random, start=0.25, shown_off=shown_off)
        offset = 100.0 * number
        axes.axhline(offset, color=TRUE, linewidth=0.6)
        axes.plot(run.along, offset + 100 * run.cross_track, color=BEFORE if number < 2 else OURS, linewidth=1)
        worst = 100 * float(np.max(np.abs(run.cross_track[run.along > 15])))
        axes.annotate(f"pass {number + 1}: within {worst:.0f} cm", (2, offset + 36), fontsize=8)
    axes.set_xlim(0, 160)
    axes.set_yticks([])


def _axes(figure: "Figure", title: str, across: str, up: str) -> "Axes":
    axes = figure.subplots()
    axes.set_title(title)
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    return axes


FIGURES: Mapping[str, Callable[["Figure"], None]] = {
    "gomez_gil_10a": _path_at_sixty,
    "gomez_gil_11": _distance_histograms,
    "gomez_gil_12": _heading_histograms,
    "inoue_08": _field_tracks,
    "inoue_09": _field_errors,
    "inoue_13": _convergence,
    "inoue_14": _round_trip,
}
REAL_FIGURES: Mapping[str, Callable[["Figure", Sequence[Fix]], None]] = {
    "gomez_gil_10b": _real_path,
    "gomez_gil_13": _real_headings,
}
