"""``guidance-app process``: logs and recordings through the whole engine without a screen, as tables."""

import argparse
import json
import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from guidance_app.batch.many import Outcome, Task, Way, drive_of, table_of
from guidance_app.batch.processing import processed
from guidance_app.batch.scoring import score_against, score_members
from guidance_app.batch.smoothing import smoothed_poses
from guidance_app.batch.spreading import clustered, spread
from guidance_app.commands.options import (
    UseError,
    add_job_options,
    filter_settings,
    job_from_options,
    refuse_documents,
)
from guidance_app.evaluation.cluster import ClusterError
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Chunk, Snapshot
from guidance_app.sources.file import load_log
from guidance_app.store.files import StoreError, write_atomically
from guidance_app.store.recordings import is_recording

__all__ = ["add_parser", "run"]

TABLE = ".csv"


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "process",
        help="run logs and recordings through the engine without a screen and write tables",
        description="Runs receiver logs and recorded drives through decoder, filter and guidance as fast as the machine"
        " can, and writes one row a fix. A recording is driven with its own documents, and its own filter unless"
        " --filter names another; a log without --field has its passes beside its first straight stretch.",
    )
    parser.add_argument(
        "inputs", nargs="+", type=Path, metavar="INPUT", help="NMEA logs, plain or .gz; recordings' folders or zips"
    )
    add_job_options(parser)
    parser.add_argument(
        "--out", type=Path, required=True, metavar="OUT", help="table to write (.csv), or a folder for one table each"
    )
    parser.add_argument(
        "--smooth", action="store_true", help="use the smoother, which knows the whole drive, not a filter"
    )
    parser.add_argument(
        "--truth", type=Path, metavar="LOG", help="score the result of one input against this log of the same drive"
    )
    parser.add_argument("--json", action="store_true", help="print the summary and the score as JSON")
    places = parser.add_mutually_exclusive_group()
    places.add_argument("--processes", type=int, metavar="N", help="on so many processors (default: all of them)")
    places.add_argument("--scheduler", metavar="ADDRESS", help="on the Dask cluster of this scheduler")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes every table whole or not at all; the status is 1 when an input of several was left out."""
    if arguments.smooth and arguments.filter is not None:
        msg = "--smooth is used instead of a filter: leave --filter out"
        raise UseError(msg)
    if any(is_recording(path) for path in arguments.inputs):
        refuse_documents(arguments)
    way = Way(job_from_options(arguments), arguments.filter, filter_settings(arguments.settings), arguments.smooth)
    if arguments.out.suffix.lower() == TABLE or arguments.truth is not None:
        return _one(arguments, way)
    return _many(arguments, way)


# --- one input into one table ----------------------------------------------------------------------------------------


def _one(arguments: argparse.Namespace, way: Way) -> int:
    if len(arguments.inputs) > 1:
        msg = f"{arguments.out} is one table, but there are {len(arguments.inputs)} inputs: name a folder by --out"
        raise UseError(msg)
    source = arguments.inputs[0]
    drive = drive_of(source, way)
    truth = None if arguments.truth is None else load_log(arguments.truth)
    estimator = smoothed_poses(drive.events, drive.job, drive.settings) if way.smooth else None
    snapshots = list(processed(drive.events, drive.job, drive.filter_name, drive.settings, estimator))
    said: dict[str, object] = {"fixes": len(snapshots), "duration_s": drive.duration, "out": str(arguments.out)}
    if drive.truncated is not None:
        said["truncated"] = drive.truncated
    if truth is not None:
        said |= _scored(snapshots, truth.chunks, arguments)
    write_atomically(arguments.out, table_of(snapshots)[0].encode())
    print(json.dumps(said, indent=1) if arguments.json else _in_words(said))
    return 0


def _scored(snapshots: list[Snapshot], truth: Sequence[Chunk], arguments: argparse.Namespace) -> dict[str, object]:
    source = arguments.inputs[0]
    origin = next((one.origin_deg for one in snapshots if one.origin_deg is not None), None)
    poses = [one.pose for one in snapshots if one.pose is not None]
    if origin is None or not poses:
        msg = f"{source} gives no position, so there is nothing to score against {arguments.truth}"
        raise UseError(msg)
    try:
        absolute, relative = score_against(poses, FieldFrame(*origin), truth)
    except ValueError as error:
        msg = f"{source} cannot be scored against {arguments.truth}: {error}"
        raise UseError(msg) from error
    return score_members(absolute, relative)


def _in_words(said: dict[str, object]) -> str:
    lines = [f"{said['out']}: {said['fixes']} fixes of {said['duration_s']:.0f} s"]
    lines += [
        f"{name}: {value:.4g}" for name, value in said.items() if isinstance(value, float) and name != "duration_s"
    ]
    if "truncated" in said:
        lines.append(str(said["truncated"]))
    return "\n".join(lines)


# --- any number into a folder ----------------------------------------------------------------------------------------


def _many(arguments: argparse.Namespace, way: Way) -> int:
    tasks = [Task(name, path, way) for name, path in _named(arguments.inputs)]
    outcomes: list[Outcome] = []
    try:
        for outcome in _outcomes(tasks, arguments):
            written = _written(outcome, arguments.out)
            outcomes.append(written)
            if not arguments.json:
                print(f"[{len(outcomes)}/{len(tasks)}] {_line(written, arguments.out)}", flush=True)
    except ClusterError as error:
        raise UseError(str(error)) from error
    bad = [one for one in outcomes if one.problem is not None]
    if arguments.json:
        print(json.dumps([_members(one) for one in outcomes], indent=1))
    if bad:
        print(f"guidance-app: {len(bad)} of {len(tasks)} inputs were left out:", file=sys.stderr)
        for one in bad:
            print(f"  {one.name}: {one.problem}", file=sys.stderr)
    return 1 if bad else 0


def _outcomes(tasks: list[Task], arguments: argparse.Namespace) -> Iterator[Outcome]:
    if arguments.scheduler is not None:
        return clustered(tasks, arguments.scheduler)
    processes = (os.cpu_count() or 1) if arguments.processes is None else arguments.processes
    if processes < 1:
        msg = f"--processes is {processes}: at least one is needed"
        raise UseError(msg)
    return spread(tasks, processes)


def _named(paths: Sequence[Path]) -> Iterator[tuple[str, Path]]:
    """A name for each table: the input's own, with a number where several share it."""
    seen: Counter[str] = Counter()
    for path in paths:
        plain = path.absolute().name if path.is_dir() else path.name.split(".")[0]
        seen[plain.casefold()] += 1
        number = seen[plain.casefold()]
        yield plain if number == 1 else f"{plain}-{number}", path


def _written(outcome: Outcome, folder: Path) -> Outcome:
    if outcome.problem is not None:
        return outcome
    try:
        write_atomically(folder / f"{outcome.name}{TABLE}", outcome.table.encode())
    except StoreError as error:
        return Outcome(outcome.name, problem=str(error))
    return outcome


def _line(outcome: Outcome, folder: Path) -> str:
    if outcome.problem is not None:
        return f"{outcome.name}: left out: {outcome.problem}"
    said = f"{folder / outcome.name}{TABLE}: {outcome.fixes} fixes of {outcome.duration:.0f} s"
    return said if outcome.truncated is None else f"{said}; {outcome.truncated}"


def _members(outcome: Outcome) -> dict[str, object]:
    members = asdict(outcome)
    del members["table"]
    return members
