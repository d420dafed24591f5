"""``guidance-app process``: a log through the whole engine without a screen, as a table."""

import argparse
import csv
import io
from pathlib import Path

from guidance_app.batch.processing import COLUMNS, processed, rows_of
from guidance_app.commands.options import add_job_options, job_from_options
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
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the table whole or not at all."""
    log = load_log(arguments.log)
    job = job_from_options(arguments)
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(COLUMNS)
    fixes = 0
    for row in rows_of(processed(log.chunks, job, arguments.filter)):
        writer.writerow(row)
        fixes += 1
    write_atomically(arguments.out, table.getvalue().encode())
    print(f"{arguments.out}: {fixes} fixes of {log.duration:.0f} s")
    return 0
