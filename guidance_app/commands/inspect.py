"""``guidance-app inspect``: what does my receiver say?"""

import argparse
import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path

from guidance_app.batch.inspection import FIX_COLUMNS, Inspection, fix_row, inspect, json_of
from guidance_app.sources.file import load_log
from guidance_app.store.files import write_atomically

__all__ = ["add_parser", "grid_in_words", "report", "run"]

METRES_PER_CENTIMETRE = 0.01
METRES_PER_MILLIMETRE = 0.001
FINEST_SHOWN = 0.0001
LEAST_IN_CENTIMETRES = 0.05
SECONDS_PER_MINUTE = 60
SECONDS_PER_HOUR = 3600


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "inspect",
        help="what does my receiver say?",
        description="Reads a receiver's log and tells what is in it: sentences, fixes, how often and how finely the"
        " receiver gives a position, and what was not believed and why.",
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="NMEA log, plain or .gz")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the table")
    parser.add_argument("--fixes", type=Path, metavar="OUT.csv", help="write every fix to this table")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Prints what was found; the table of fixes is written whole or not at all."""
    log = load_log(arguments.log)
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(FIX_COLUMNS)
    found = inspect(log, None if arguments.fixes is None else lambda fix: writer.writerow(fix_row(fix)))
    if arguments.fixes is not None:
        write_atomically(arguments.fixes, table.getvalue().encode())
    if arguments.json:
        print(json.dumps(json_of(found), indent=2))
    else:
        print(report(arguments.log.name, found))
        if arguments.fixes is not None:
            print(f"\n{found.fixes} fixes written to {arguments.fixes}")
    return 0


def report(name: str, found: Inspection) -> str:
    """The table for a person."""
    rows = [
        ("sentences", f"{found.sentences:,} seen, {found.decoded:,} decoded"),
        ("kinds", _counts(found.kinds)),
        ("rejected", _counts(found.rejected) or "none"),
        ("fixes", _fixes(found)),
        ("quality", _counts({kind.replace("_", " "): count for kind, count in found.quality.items()}) or "-"),
        ("interval", "-" if found.interval is None else f"{found.interval:.3g} s ({1 / found.interval:.3g} Hz)"),
        ("duration", _duration(found.duration)),
        ("length", f"{found.length:,.0f} m"),
        ("grid", "-" if found.cell is None else f"this receiver rounds to {grid_in_words(found.cell)}"),
    ]
    if found.without_checksum:
        rows.insert(1, ("", f"{found.without_checksum:,} of them without a checksum: this receiver sends none"))
    if not found.fixes:
        rows.append(("", "There is no fix in this log: the receiver never had a position, or sent no GGA, RMC or GNS."))
    return "\n".join([name, *(f"  {title:<10} {text}" for title, text in rows)])


def grid_in_words(cell: tuple[float, float]) -> str:
    """A rounding (north, east) as east x north: ``14 x 18 cm``."""
    north, east = cell
    if north < FINEST_SHOWN:
        return "less than 0.1 mm"
    if north >= 1.0:
        return f"{east:.1f} x {north:.1f} m"
    if min(north, east) >= LEAST_IN_CENTIMETRES:
        return f"{east / METRES_PER_CENTIMETRE:.0f} x {north / METRES_PER_CENTIMETRE:.0f} cm"
    return f"{east / METRES_PER_MILLIMETRE:.2g} x {north / METRES_PER_MILLIMETRE:.2g} mm"


def _fixes(found: Inspection) -> str:
    parts = [f"{found.fixes:,}"]
    if found.no_fixes:
        parts.append(f"{found.no_fixes:,} epochs without a fix")
    if found.attitudes:
        parts.append(f"{found.attitudes:,} readings of attitude beside them")
    return ", ".join(parts)


def _counts(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{count:,} {name}" for name, count in counts.items())


def _duration(seconds: float) -> str:
    if seconds < 2 * SECONDS_PER_MINUTE:
        return f"{seconds:.1f} s"
    if seconds < SECONDS_PER_HOUR:
        return f"{seconds / SECONDS_PER_MINUTE:.1f} min"
    hours, rest = divmod(round(seconds / SECONDS_PER_MINUTE), 60)
    return f"{hours} h {rest} min"
