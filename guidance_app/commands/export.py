"""``guidance-app export``: a recorded drive, or a receiver's log, for other programs."""

import argparse
from pathlib import Path

from guidance_app.batch.exporting import drive_export, log_export
from guidance_app.commands.options import (
    UseError,
    add_job_options,
    filter_settings,
    job_from_options,
    refuse_documents,
)
from guidance_app.exchange.drives import DRIVE_WRITERS, DriveExport
from guidance_app.sources.file import load_log
from guidance_app.store.files import write_atomically
from guidance_app.store.recordings import is_recording, open_recording

__all__ = ["add_parser", "run"]

SQUARE_METRES = 10_000.0
"""Of a hectare."""


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    formats = "; ".join(f"{name}: {one.words} ({one.ending})" for name, one in DRIVE_WRITERS.items())
    parser = subparsers.add_parser(
        "export",
        help="write a drive for other programs",
        description="Drives a recording, or a receiver's log, once more without a screen and writes it for other"
        f" programs. {formats}.",
    )
    parser.add_argument(
        "drive", type=Path, metavar="RECORDING", help="folder or zip of a recording; NMEA log, plain or .gz"
    )
    add_job_options(parser)
    parser.add_argument("--format", choices=tuple(DRIVE_WRITERS), required=True, help="what to write")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="file to write")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the file whole or not at all."""
    form = DRIVE_WRITERS[arguments.format]
    if arguments.out.suffix.lower() != form.ending:
        msg = (
            f"{arguments.out}: a drive as {arguments.format} is a {form.ending} file, so end its name in {form.ending}"
        )
        raise UseError(msg)
    gathered = _of_recording(arguments) if is_recording(arguments.drive) else _of_log(arguments)
    if not gathered.epochs:
        msg = f"{arguments.drive} holds no position fix, so there is no drive to write"
        raise UseError(msg)
    content = form.write(gathered)
    write_atomically(arguments.out, content)
    print(_in_words(gathered, arguments.out, len(content)))
    return 0


def _of_recording(arguments: argparse.Namespace) -> DriveExport:
    refuse_documents(arguments)
    drive = open_recording(arguments.drive)
    if drive.truncated is not None:
        print(drive.truncated)
    return drive_export(drive, arguments.filter, filter_settings(arguments.settings))


def _of_log(arguments: argparse.Namespace) -> DriveExport:
    log = load_log(arguments.drive)
    return log_export(log, job_from_options(arguments), arguments.filter, filter_settings(arguments.settings))


def _in_words(drive: DriveExport, out: Path, size: int) -> str:
    areas = f"{drive.worked_area / SQUARE_METRES:.2f} ha worked"
    if drive.skipped_area is not None:
        areas += f", {drive.skipped_area / SQUARE_METRES:.2f} ha of the field not worked"
    return f"{out}: {len(drive.epochs)} epochs, {areas}, {size / 1000:,.0f} kB"
