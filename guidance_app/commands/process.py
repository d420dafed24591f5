"""``guidance-app process``: a log through the whole engine without a screen, as a table."""

import argparse
import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path

from guidance_app.batch.processing import COLUMNS, processed, rows_of
from guidance_app.batch.scoring import score_against, score_members
from guidance_app.batch.smoothing import smoothed_poses
from guidance_app.commands.options import UseError, add_job_options, filter_settings, job_from_options
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Chunk, Snapshot
from guidance_app.sources.file import load_log
from guidance_app.store.files import write_atomically

__all__ = ["add_parser", "run"]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "process",
        help="run a log through the engine without a screen and write a table",
        description="Runs a receiver log through decoder, filter and guidance as fast as the machine can, and writes"
        " one row a fix. Without --field the passes lie beside the first straight stretch.",
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="NMEA log, plain or .gz")
    add_job_options(parser)
    parser.add_argument("--out", type=Path, required=True, metavar="OUT.csv", help="table to write")
    parser.add_argument(
        "--smooth", action="store_true", help="use the smoother, which knows the whole log, not a filter"
    )
    parser.add_argument(
        "--truth", type=Path, metavar="LOG", help="score the result against this reference log of the same drive"
    )
    parser.add_argument("--json", action="store_true", help="print the summary and the score as JSON")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the table whole or not at all."""
    if arguments.smooth and arguments.filter is not None:
        msg = "--smooth is used instead of a filter: leave --filter out"
        raise UseError(msg)
    log = load_log(arguments.log)
    truth = None if arguments.truth is None else load_log(arguments.truth)
    job = job_from_options(arguments)
    settings = filter_settings(arguments.settings)
    estimator = smoothed_poses(log.chunks, job, settings) if arguments.smooth else None
    snapshots = list(processed(log.chunks, job, arguments.filter, settings, estimator))
    said: dict[str, object] = {"fixes": len(snapshots), "duration_s": log.duration, "out": str(arguments.out)}
    if truth is not None:
        said |= _scored(snapshots, truth.chunks, arguments)
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(rows_of(snapshots))
    write_atomically(arguments.out, table.getvalue().encode())
    print(json.dumps(said, indent=1) if arguments.json else _in_words(said))
    return 0


def _scored(snapshots: list[Snapshot], truth: Sequence[Chunk], arguments: argparse.Namespace) -> dict[str, object]:
    origin = next((one.origin_deg for one in snapshots if one.origin_deg is not None), None)
    poses = [one.pose for one in snapshots if one.pose is not None]
    if origin is None or not poses:
        msg = f"{arguments.log} gives no position, so there is nothing to score against {arguments.truth}"
        raise UseError(msg)
    try:
        absolute, relative = score_against(poses, FieldFrame(*origin), truth)
    except ValueError as error:
        msg = f"{arguments.log} cannot be scored against {arguments.truth}: {error}"
        raise UseError(msg) from error
    return score_members(absolute, relative)


def _in_words(said: dict[str, object]) -> str:
    lines = [f"{said['out']}: {said['fixes']} fixes of {said['duration_s']:.0f} s"]
    lines += [
        f"{name}: {value:.4g}" for name, value in said.items() if isinstance(value, float) and name != "duration_s"
    ]
    return "\n".join(lines)
