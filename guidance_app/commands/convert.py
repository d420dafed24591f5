"""``guidance-app convert``: fields and time logs of other programs, looked at and turned into other formats."""

import argparse
import re
from pathlib import Path

from guidance_app.batch.time_logs import field_of, job_of, recording_of
from guidance_app.commands.options import UseError
from guidance_app.exchange import (
    WRITERS,
    ExchangeError,
    ImportedField,
    QuestionError,
    ReadOptions,
    read_fields,
    write_field,
)
from guidance_app.exchange.time_log_drive import nmea_of, read_time_log, time_log_names
from guidance_app.geodesy import CoordinateSystem, Datum, Projection
from guidance_app.store.files import write_atomically

__all__ = ["add_parser", "run", "system_from_text"]

SQUARE_METRES = 10_000.0
"""Of a hectare."""
RECORDING, NMEA = ".zip", ".nmea"
_match_system = re.compile(r"(degrees|utm|plane)\s*(\d{1,2})?\s*([ns])?").fullmatch


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "convert",
        help="look into field files and time logs of other programs, and convert them",
        description="Says which fields and time logs a file, folder or archive of another program holds, with all that"
        " was assumed or repaired. With --out the field is written in the format of the ending"
        f" ({', '.join(sorted(WRITERS))}); with --log a time log of ISOXML becomes a recording ({RECORDING}), which"
        f" replay plays, or an NMEA log ({NMEA}).",
    )
    parser.add_argument("source", type=Path, metavar="FILE", help="file, folder or archive")
    parser.add_argument("--out", type=Path, metavar="FILE", help="file to write")
    parser.add_argument("--name", help="which of several fields to write")
    parser.add_argument("--log", metavar="NAME", help="time log to write, as TLG00001")
    parser.add_argument(
        "--system",
        type=_system,
        metavar="SYSTEM",
        help="coordinate system of a file that does not name it: degrees, 'utm 32', 'utm 32 S', 'plane 9'",
    )
    parser.add_argument("--tokyo", action="store_true", help="these coordinates are on the Tokyo datum")
    parser.add_argument("--order", choices=("north first", "east first"), help="order of the columns of a list")
    parser.add_argument("--encoding", help="encoding of the names, as cp932")
    parser.add_argument("--inexact", action="store_true", help="accept a change of datum that is metres off")
    parser.set_defaults(func=run)


def system_from_text(text: str, datum: Datum = Datum.WORLD) -> CoordinateSystem:
    """``degrees``, ``utm 32``, ``utm 32 S`` or ``plane 9``. Raises ``ValueError``."""
    match = _match_system(text.strip().lower())
    if match is None:
        msg = f"'{text}' is no coordinate system; say degrees, 'utm 32', 'utm 32 S' or 'plane 9'"
        raise ValueError(msg)
    kind, zone, side = match.groups()
    projection = {"degrees": Projection.GEOGRAPHIC, "utm": Projection.UTM, "plane": Projection.PLANE_RECTANGULAR}[kind]
    return CoordinateSystem(projection, datum, None if zone is None else int(zone), side == "s")


def run(arguments: argparse.Namespace) -> int:
    """Says what is in the source, or writes one thing of it, whole or not at all."""
    options = _options(arguments)
    if arguments.log is not None:
        return _write_log(arguments)
    try:
        fields = read_fields(arguments.source, options=options)
    except QuestionError as question:
        raise UseError(f"{question}: use --{question.option}") from question
    if arguments.out is None:
        print(f"{arguments.source}")
        for field in fields:
            print(_in_words(field))
        for log in _logs(arguments.source):
            print(f"  time log {log}: write it with --log {log} --out FILE{RECORDING}")
        return 0
    chosen = _chosen(fields, arguments)
    write_field(chosen.document, arguments.out)
    print(f"{arguments.out}:\n{_in_words(chosen)}")
    return 0


def _options(arguments: argparse.Namespace) -> ReadOptions:
    text = arguments.system
    datum = Datum.TOKYO if arguments.tokyo else Datum.WORLD
    if text is None and arguments.tokyo:
        text = "degrees"
    try:
        system = None if text is None else system_from_text(text, datum)
    except ValueError as error:
        raise UseError(str(error)) from error
    return ReadOptions(system, arguments.order, arguments.encoding, arguments.inexact)


def _system(text: str) -> str:
    """The text when it is a system on the world datum or without a zone of its own; the datum comes later."""
    try:
        system_from_text(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return text


def _chosen(fields: tuple[ImportedField, ...], arguments: argparse.Namespace) -> ImportedField:
    called = [field for field in fields if arguments.name in (None, field.name)]
    if len(called) == 1:
        return called[0]
    names = ", ".join(field.name for field in fields[:8]) + (", ..." if len(fields) > 8 else "")
    which = "is called so" if arguments.name else "can be written at a time"
    msg = f"{arguments.source}: {len(called)} of {len(fields)} fields {which}; choose with --name from {names}"
    raise UseError(msg)


def _in_words(field: ImportedField) -> str:
    lines = [f"  {field.name}: {field.area / SQUARE_METRES:.2f} ha, {len(field.lines)} guidance lines"]
    lines += [f"    repaired or left out: {warning}" for warning in field.warnings]
    lines += [f"    assumed: {said}" for said in field.assumptions]
    return "\n".join(lines)


def _logs(source: Path) -> tuple[str, ...]:
    try:
        return time_log_names(source)
    except ExchangeError:
        return ()  # no ISOXML, so no time log


def _write_log(arguments: argparse.Namespace) -> int:
    if arguments.out is None or arguments.out.suffix.lower() not in {RECORDING, NMEA}:
        msg = f"a time log is written with --out FILE{RECORDING} (a recording) or --out FILE{NMEA}"
        raise UseError(msg)
    log = read_time_log(arguments.source, arguments.log)
    if arguments.out.suffix.lower() == NMEA:
        content = nmea_of(log)
    else:
        content = recording_of(log, job_of(log, field_of(arguments.source, log)))
    write_atomically(arguments.out, content)
    print(f"{arguments.out}: time log {log.name} of '{log.task}', {len(log.rows)} positions")
    for warning in log.warnings:
        print(f"  {warning}")
    return 0
