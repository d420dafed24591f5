"""``guidance-app ledger``: the operation report of recordings, as PDF, workbook or table."""

import argparse
import datetime
import sys
from collections.abc import Callable
from pathlib import Path

from guidance_app.batch.ledgers import Choice, ledger_entries
from guidance_app.commands.options import UseError, add_data_option, chosen_data_folder
from guidance_app.language import LANGUAGES, words_for
from guidance_app.reports import SHEETS
from guidance_app.store.recordings_list import list_recordings

__all__ = ["add_parser", "run"]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "ledger",
        help="the sheet to hand in: what was worked where, when and how well",
        description="Writes the ledger of the given recordings, or of all in the data folder of a day or a time.",
    )
    parser.add_argument(
        "recordings",
        nargs="*",
        type=Path,
        metavar="RECORDING",
        help="folders or zips of recordings, all of which are taken",
    )
    parser.add_argument("--day", type=_day, metavar="YYYY-MM-DD", help="all of this day (this machine's time zone)")
    parser.add_argument(
        "--from", dest="first", type=_day, metavar="YYYY-MM-DD", help="all from this day on (this machine's time zone)"
    )
    parser.add_argument(
        "--to", dest="last", type=_day, metavar="YYYY-MM-DD", help="all up to this day (this machine's time zone)"
    )
    parser.add_argument("--field", metavar="NAME", help="only drives on this field")
    parser.add_argument("--title", default="", help="what stands above the sheet")
    parser.add_argument("--language", choices=LANGUAGES, default="en", help="of the sheet (default en)")
    kinds = ", ".join(sorted(SHEETS))
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help=f"by its ending: {kinds}")
    add_data_option(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the sheet; a recording that cannot be opened is said and left out, and the status is 1 then."""
    sheet = SHEETS.get(arguments.out.suffix.lower())
    if sheet is None:
        msg = f"{arguments.out}: a ledger is written as {', '.join(sorted(SHEETS))}"
        raise UseError(msg)
    words = words_for(arguments.language)
    data = chosen_data_folder(arguments)
    choice = Choice(arguments.day or arguments.first, arguments.day or arguments.last, arguments.field)
    listed = list_recordings(data)
    paths = arguments.recordings or [one.path for one in listed if choice.takes(one)]
    found = ledger_entries(paths, data, _teller(paths))
    for reason in found.left_out:
        print(f"left out: {reason}", file=sys.stderr)
    if not found.entries:
        msg = f"no recording fits: there are {len(listed)} in {data}"
        raise UseError(msg)
    try:
        arguments.out.write_bytes(sheet(found.entries, arguments.title or words("Ledger"), words))
    except OSError as error:
        msg = f"{arguments.out} cannot be written: {error.strerror}"
        raise UseError(msg) from error
    print(f"{arguments.out}: {len(found.entries)} drives, {found.worked / 10_000:.2f} ha")
    return 1 if found.left_out else 0


def _teller(paths: list[Path]) -> Callable[[int, float], None]:
    """Says each recording once."""
    told: set[int] = set()

    def tell(number: int, done: float) -> None:
        del done
        if number not in told:
            told.add(number)
            print(f"{number + 1} of {len(paths)}: {paths[number].name}", file=sys.stderr)

    return tell


def _day(text: str) -> datetime.date:
    try:
        return datetime.date.fromisoformat(text)
    except ValueError:
        msg = f"{text!r} is no day; write it like 2026-05-31"
        raise argparse.ArgumentTypeError(msg) from None
