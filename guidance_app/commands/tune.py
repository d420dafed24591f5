"""``guidance-app tune``: find Q and R of the four-state filter on simulated paths or on one's own recordings."""

import argparse
import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from guidance_app.estimation.filter import FilterSettings, QuantisationSettings
from guidance_app.evaluation.cluster import ClusterError, cluster_search
from guidance_app.evaluation.model_tuning import KINDS, ModelObjective, model_search, model_settings
from guidance_app.evaluation.objectives import (
    Objective,
    TuningError,
    mixed_objective,
    recorded_objective,
    straight_objective,
)
from guidance_app.evaluation.real import fixes_of, frame_of, recording_from_fixes
from guidance_app.evaluation.tracks import Recording
from guidance_app.evaluation.tuning import (
    Found,
    OptimiserMissingError,
    chunks_of,
    cma_search,
    cross_validation,
    noise_of,
    random_search,
    settings_from,
)
from guidance_app.model import RECEIVER, Chunk, FloatArray
from guidance_app.sources import SourceError
from guidance_app.sources.file import load_log
from guidance_app.store import StoreError
from guidance_app.store.recordings import is_recording, open_recording

__all__ = ["add_parser", "run"]

BAR = 24
Search = Callable[[Objective], Iterator[Found]]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Declares the command and its options."""
    parser = subparsers.add_parser(
        "tune",
        help="find the four-state filter's Q and R, on simulated paths or on your recordings",
        description=(
            "Finds the process and measurement noise (Q and R) of the filter quantisation_kf. Without --log on the"
            " 18 straight lines of Gomez-Gil et al. (2013) and on paths that turn; with --log on your own recordings,"
            " checked by cross-validation. Ctrl-C keeps the best so far."
        ),
    )
    parser.add_argument(
        "--log",
        nargs="+",
        type=Path,
        action="extend",
        metavar="LOG",
        help="recordings of yours: NMEA logs, plain or .gz; recordings' folders or zips",
    )
    parser.add_argument(
        "--straight-only",
        action="store_true",
        help="the paper's 18 straight lines alone; such a filter does not turn, and the result says by how much",
    )
    parser.add_argument(
        "--method", choices=("cma", "random"), default="cma", help="CMA-ES, or the paper's Monte Carlo (random)"
    )
    parser.add_argument("--samples", type=_count, default=2_000_000, help="draws of the Monte Carlo (2000000)")
    parser.add_argument(
        "--processes", type=_count, default=os.cpu_count() or 1, help="processes of the Monte Carlo (all cores)"
    )
    parser.add_argument("--scheduler", metavar="ADDRESS", help="run the Monte Carlo on this Dask scheduler, tcp://...")
    parser.add_argument(
        "--models",
        choices=tuple(KINDS),
        help="tune the adaptive filter's motion models for this kind of input instead; takes minutes",
    )
    parser.add_argument("--seeds", type=_count, default=8, help="runs of each scenario for --models (8)")
    parser.add_argument("--out", type=Path, metavar="SETTINGS.json", help="write the filter settings here")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Tunes, says what was found, and writes it. 0 also when Ctrl-C ended it early with a result."""
    try:
        return _tune(arguments)
    except (TuningError, OptimiserMissingError, ClusterError, SourceError, StoreError) as error:
        print(f"tune: {error}", file=sys.stderr)
        return 2


def _tune(arguments: argparse.Namespace) -> int:
    if arguments.models is not None:
        return _tune_models(arguments)
    logs: Sequence[Path] = arguments.log or ()
    objective = _objective(logs, straight_only=arguments.straight_only)
    search = _search(arguments)
    found, stopped = _watched(search(objective))
    if found is None:
        print("tune: stopped before the first result; nothing is kept", file=sys.stderr)
        return 130
    if stopped:
        print(f"stopped after {found.evaluations:,} evaluations; the best so far is kept")
    for line in _report(objective, found, arguments):
        print(line)
    written = _written(settings_from(found.noise), arguments.out)
    if logs and not stopped:
        _validate(objective, search)
    return written


def _tune_models(arguments: argparse.Namespace) -> int:
    """The adaptive filter's motion models for one kind of input."""
    if arguments.log:
        msg = "--models is tuned on simulated paths with their truth; leave --log away"
        raise TuningError(msg)
    kind = arguments.models
    objective = ModelObjective(kind, arguments.seeds)
    found, stopped = _watched(model_search(objective), lambda best: f"{math.log(best.rms):.4f}")
    if found is None:
        print("tune: stopped before the first result; nothing is kept", file=sys.stderr)
        return 130
    if stopped:
        print(f"stopped after {found.evaluations:,} evaluations; the best so far is kept")
    settings = model_settings(kind, found.noise)
    print("models  " + "  ".join(f"{value:.4g}" for value in found.noise.tolist()))
    for title, chosen in (("tuned", settings), ("present", FilterSettings())):
        for (name, rate), score in objective.scores(chosen).items():
            heading = math.degrees(score.heading_rms or 0.0)
            honest = 100 * (score.within_ellipse or 0.0)
            print(f"{title:<8} {name:<16} {rate:g} Hz  {100 * score.rms:6.2f} cm  {heading:5.2f} deg  {honest:3.0f} %")
    return _written(settings, arguments.out)


def _objective(logs: Sequence[Path], *, straight_only: bool) -> Objective:
    if logs:
        return recorded_objective([_serving(path) for path in logs])
    return straight_objective() if straight_only else mixed_objective()


def _serving(path: Path) -> Recording:
    """The fixes of a log or recording in a frame of its own. One that tells nothing of driving is refused by name."""
    fixes = fixes_of(_received(path))
    if not fixes:
        msg = f"{path} holds no fix"
        raise TuningError(msg)
    recording = recording_from_fixes(fixes, frame_of(fixes))
    try:
        recorded_objective([recording])
    except TuningError as error:
        msg = f"{path}: {error}"
        raise TuningError(msg) from error
    return recording


def _received(path: Path) -> bytes:
    """What the receiver sent."""
    if not is_recording(path):
        return b"".join(chunk.data for chunk in load_log(path).chunks)
    drive = open_recording(path)
    if drive.truncated is not None:
        print(f"tune: {path}: {drive.truncated}", file=sys.stderr)
    return b"".join(one.data for one in drive.events if isinstance(one, Chunk) and one.link == RECEIVER)


def _search(arguments: argparse.Namespace) -> Search:
    if arguments.scheduler:
        if arguments.method == "cma":
            msg = "CMA-ES takes seconds and runs here; a cluster is for --method random"
            raise ClusterError(msg)
        return lambda objective: cluster_search(objective, chunks_of(arguments.samples), arguments.scheduler)
    if arguments.method == "random":
        return lambda objective: random_search(objective, chunks_of(arguments.samples), arguments.processes)
    return cma_search


def _in_centimetres(found: Found) -> str:
    return f"{100 * found.rms:.3f} cm"


def _watched(finding: Iterator[Found], said: Callable[[Found], str] = _in_centimetres) -> tuple[Found | None, bool]:
    """The last result and whether Ctrl-C ended the search; a progress bar runs on stderr meanwhile."""
    found, stopped = None, False
    bar = _Bar(said)
    try:
        for found in finding:
            bar.show(found)
    except KeyboardInterrupt:
        stopped = True
    bar.end()
    return found, stopped


class _Bar:
    """The progress on stderr: one line that is drawn over on a terminal, else a new line every ten percent."""

    def __init__(self, said: Callable[[Found], str]) -> None:
        self._said = said
        self._over = sys.stderr.isatty()
        self._last = -1

    def show(self, found: Found) -> None:
        """Says how far it is, when that has changed enough."""
        percent = min(100, 100 * found.evaluations // max(found.of, 1))
        shown = percent if self._over else percent // 10 * 10
        if shown == self._last:
            return
        self._last = shown
        bar = "#" * (BAR * percent // 100)
        text = f"[{bar:<{BAR}}] {percent:3} %  {found.evaluations:,} evaluations, best {self._said(found)}"
        print(f"\r{text}" if self._over else text, end="" if self._over else "\n", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Leaves the line."""
        if self._over and self._last >= 0:
            print(file=sys.stderr)


def _report(objective: Objective, found: Found, arguments: argparse.Namespace) -> Iterator[str]:
    """What was found, against the paper's equation 14, on straight lines and on paths that turn."""
    default = noise_of(QuantisationSettings())
    q, r, _ = np.split(found.noise, 3)
    yield f"Q  {_listed(q)}   (east, north, heading, speed)"
    yield f"R  {_listed(r)}"
    if arguments.log:
        yield _compared("one second ahead, your recordings", objective, found.noise, default)
        return
    both = mixed_objective()
    yield _compared("18 straight lines", both.only("lines"), found.noise, default)
    turning = both.only(*(name for name in both.names if name != "lines"))
    yield _compared("arcs, U-turn and meander", turning, found.noise, default)
    if arguments.straight_only:
        off = 100 * both.only("arc50").rms(found.noise)
        yield (
            f"Tuned on straight lines alone: {off:.0f} cm off on an arc of 50 m radius. Do not drive curves with it;"
            " leave --straight-only away for a filter that turns."
        )


def _compared(title: str, objective: Objective, noise: FloatArray, default: FloatArray) -> str:
    ours, paper = 100 * objective.rms(noise), 100 * objective.rms(default)
    return f"{title}: {ours:.2f} cm   (paper's matrices: {paper:.2f} cm)"


def _listed(values: FloatArray) -> str:
    return "  ".join(f"{value:.4g}" for value in values.tolist())


def _written(settings: FilterSettings, out: Path | None) -> int:
    if out is None:
        return 0
    try:
        out.write_text(settings.model_dump_json(indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        print(f"tune: cannot write {out}: {error.strerror}", file=sys.stderr)
        return 1
    print(f"settings written to {out}")
    return 0


def _validate(objective: Objective, search: Search) -> None:
    """Cross-validation after the result is safe, so that Ctrl-C costs only the check."""
    if len(objective.names) < 2:
        print("one unbroken piece of recording: no cross-validation possible")
        return
    try:
        for check in cross_validation(objective, search):
            print(f"cross-validation: {check.folds} parts left out in turn", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        print("cross-validation stopped; the result above stands", file=sys.stderr)
        return
    print(
        f"cross-validation over {check.folds} parts: {100 * check.tuned:.2f} cm on what the tuning did not see"
        f"   (paper's matrices: {100 * check.default:.2f} cm)"
    )
    if check.tuned >= check.default:
        print("the tuning is no better than the paper's matrices on unseen parts: keep the defaults")


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        msg = f"{text} is not a positive number"
        raise argparse.ArgumentTypeError(msg)
    return value
