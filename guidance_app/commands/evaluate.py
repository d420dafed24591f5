"""``guidance-app evaluate``: rerun both papers' protocols and our scenarios, and say paper, peer, ours and goal."""

import argparse
import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import guidance_app
from guidance_app.bench.filters import filter_rows, tuning_rows
from guidance_app.evaluation.comparisons import scenario_rows
from guidance_app.evaluation.figures import FiguresMissingError, draw_figures
from guidance_app.evaluation.gomez_gil import table_1, table_2
from guidance_app.evaluation.inoue import inoue_rows
from guidance_app.evaluation.parallel import Spread, spread_over
from guidance_app.evaluation.real import car_rows, fixes_of, tractor_rows
from guidance_app.evaluation.rows import Row, as_dicts, as_table, unmet
from guidance_app.evaluation.steering import steering_rows
from guidance_app.evaluation.tuning import OptimiserMissingError
from guidance_app.model import Fix

__all__ = ["add_parser", "run"]

CAR = ("nmea/car_rtk_with_truth/MTV.Local1.ublox-F9K.20200206-181434.nmea",
       "nmea/car_rtk_with_truth/MTV.Local1.SPAN.20200206-181434.gga")  # fmt: skip
TRACTOR_FINE = "nmea/tractor_9m/impl9m_TLG00001_7dec.nmea"
TRACTOR_COARSE = ("nmea/tractor_9m/impl9m_TLG00001_4dec.nmea", "nmea/tractor_9m/impl9m_TLG00008_4dec.nmea")
MOST_DRIVES = 30
"""Inoue's field test is long; its means are steady after so many drives."""


class EvaluationError(Exception):
    """Why an evaluation cannot be made, in a sentence."""


@dataclass(frozen=True, slots=True)
class _Wish:
    """What was asked for."""

    seeds: int
    processes: int
    spread: Spread
    logs: Path | None


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Declares the command and its options."""
    parser = subparsers.add_parser(
        "evaluate",
        help="rerun the papers' protocols and our scenarios: paper, peer, ours, goal",
        description="Reruns the protocols of both papers and our scenarios and prints paper, peer, ours and goal.",
    )
    parser.add_argument(
        "protocol", nargs="?", default="all", choices=(*PROTOCOLS, "all"), help="which to run (all of them)"
    )
    parser.add_argument("--seeds", type=_count, default=100, help="runs of each scenario (100)")
    parser.add_argument("--processes", type=_count, default=os.cpu_count() or 1, help="processes (all cores)")
    parser.add_argument("--json", action="store_true", help="print the rows as a JSON list")
    parser.add_argument("--figures", type=Path, metavar="DIR", help="draw the papers' figures there, as PNG and SVG")
    parser.add_argument("--data-logs", type=Path, metavar="DIR", help="folder of the real recordings")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Prints the rows. 0 also when goals are not met: a row says so itself."""
    try:
        rows = _rows(arguments)
        if arguments.figures is not None:
            logs = _logs(arguments.data_logs)
            tractor = None if logs is None else _fixes(logs / TRACTOR_COARSE[0])
            for path in draw_figures(arguments.figures, tractor):
                print(path, file=sys.stderr)
    except (EvaluationError, FiguresMissingError, OptimiserMissingError) as error:
        print(f"evaluate: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"evaluate: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    if arguments.json:
        print(json.dumps(as_dicts(rows), indent=1))
        return 0
    print(as_table(rows))
    missed = unmet(rows)
    judged = [row for row in rows if row.goal is not None]
    print(f"\n{len(judged) - len(missed)} of {len(judged)} goals met" + ("; * marks the others" if missed else ""))
    return 0


def _rows(arguments: argparse.Namespace) -> list[Row]:
    chosen = list(PROTOCOLS) if arguments.protocol == "all" else [arguments.protocol]
    logs = _logs(arguments.data_logs)
    if logs is None and arguments.protocol == "all":
        print("evaluate: no folder of real recordings found; 'real' is left out (--data-logs DIR)", file=sys.stderr)
        chosen.remove("real")
    with spread_over(arguments.processes) as spread:
        wish = _Wish(arguments.seeds, arguments.processes, spread, logs)
        rows: list[Row] = []
        for name in chosen:
            print(f"evaluate: {name} ...", file=sys.stderr, flush=True)
            rows += PROTOCOLS[name](wish)
        return rows


def _gomez_gil(wish: _Wish) -> list[Row]:
    return [*table_1(), *table_2(), *tuning_rows(wish.processes)]


def _inoue(wish: _Wish) -> list[Row]:
    return [*inoue_rows(min(wish.seeds, MOST_DRIVES), wish.spread), *steering_rows(wish.seeds)]


def _scenarios(wish: _Wish) -> list[Row]:
    return [*scenario_rows(wish.seeds, wish.spread), *filter_rows()]


def _real(wish: _Wish) -> list[Row]:
    if wish.logs is None:
        msg = "the real recordings were not found; name their folder with --data-logs DIR"
        raise EvaluationError(msg)
    receiver, reference = (_fixes(wish.logs / name) for name in CAR)
    coarse = {Path(name).stem: _fixes(wish.logs / name) for name in TRACTOR_COARSE}
    return [*car_rows(receiver, reference), *tractor_rows(_fixes(wish.logs / TRACTOR_FINE), coarse)]


PROTOCOLS: Mapping[str, Callable[[_Wish], Sequence[Row]]] = MappingProxyType(
    {"gomez-gil": _gomez_gil, "inoue": _inoue, "scenarios": _scenarios, "real": _real}
)


def _logs(given: Path | None) -> Path | None:
    """The folder of real recordings: the one given, else that beside the checkout; None where there is none."""
    if given is not None:
        if not (given / CAR[0]).is_file():
            msg = f"{given} does not hold {CAR[0]}"
            raise EvaluationError(msg)
        return given
    beside = Path(guidance_app.__file__).resolve().parents[2] / "shared" / "data"
    return beside if (beside / CAR[0]).is_file() else None


def _fixes(path: Path) -> list[Fix]:
    fixes = fixes_of(path.read_bytes())
    if not fixes:
        msg = f"{path} holds no fix"
        raise EvaluationError(msg)
    return fixes


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        msg = f"{text} is not a positive number"
        raise argparse.ArgumentTypeError(msg)
    return value
