"""``guidance-app run``: the console on a live source, recorded into the data folder."""

import argparse
import os
from pathlib import Path

from guidance_app.commands.options import (
    UseError,
    add_console_options,
    add_data_option,
    add_job_options,
    chosen_data_folder,
    filter_settings,
    job_from_options,
)
from guidance_app.commands.serving import serve
from guidance_app.runtime import LiveSession, caster_for, recorded_session, resumed_session
from guidance_app.sources import SOURCES, Source, open_source
from guidance_app.sources.ntrip import Caster, caster_from_uri
from guidance_app.store import StoreError
from guidance_app.store.recordings_list import Resumable, resumable

__all__ = ["add_parser", "run"]

PASSWORD = "GUIDANCE_NTRIP_PASSWORD"  # noqa: S105 - the name of an environment variable


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    known = " ".join(f"{scheme}:" for scheme in SOURCES)
    parser = subparsers.add_parser(
        "run",
        help="drive: the console on a live receiver",
        description=f"Opens the console: on a live source, or where fields and machines are set up. Sources: {known}",
    )
    parser.add_argument(
        "--source",
        metavar="URI",
        help=f"drive at once from here: {known} (without it the console opens where operations are started)",
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on with the last drive, which was cut off, with its documents"
    )
    parser.add_argument("--attitude", metavar="URI", help="an attitude sensor on a port of its own, in the same words")
    parser.add_argument(
        "--ntrip",
        metavar="URI",
        help="corrections for the receiver, from ntrip://user:password@host:2101/MOUNT; the password may stand in"
        f" {PASSWORD} instead, where no other user of this machine sees it (without it the caster that was entered at"
        " the screen)",
    )
    add_job_options(parser)
    add_data_option(parser)
    add_console_options(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Drives until stopped."""
    data = chosen_data_folder(arguments)
    if arguments.source is None:
        if arguments.attitude is not None or arguments.ntrip is not None:
            msg = "--attitude and --ntrip stand beside a receiver: name the receiver by --source"
            raise UseError(msg)
        if arguments.resume:
            msg = "--resume goes on with a drive: name its receiver by --source"
            raise UseError(msg)
        return serve(None, arguments, data, "nothing is driven yet: choose at the screen")
    source = open_source(arguments.source, arguments.attitude, _caster(arguments, data))
    found = resumable(data)
    if arguments.resume:
        session = _resumed(found, source, data)
    else:
        if found is not None:
            print(f"{_told(found)}: go on with it by --resume")
        job = job_from_options(arguments)
        settings = filter_settings(arguments.settings)
        session = recorded_session(data, job, source, arguments.filter, settings)
    return serve(session, arguments, data, f"reading {source.description}")


def _caster(arguments: argparse.Namespace, data: Path) -> Caster | None:
    """The one that is named, else that of the screen. An account that cannot be read stops no drive."""
    if arguments.ntrip is not None:
        return caster_from_uri(arguments.ntrip, os.environ.get(PASSWORD))
    try:
        return caster_for(data, arguments.source)
    except StoreError as error:
        print(f"driving without corrections: {error}")
        return None


def _resumed(found: Resumable | None, source: Source, data: Path) -> LiveSession:
    if found is None:
        msg = f"no drive was cut off in {data}: leave --resume out"
        raise UseError(msg)
    print(f"{_told(found)}; taking it again")
    return resumed_session(found.path, source)


def _told(found: Resumable) -> str:
    where = "" if found.field is None else f" on '{found.field}'"
    at = "" if found.pass_number is None else f", at pass {found.pass_number}"
    of = "" if found.passes_planned is None else f", {found.passes_done} of {found.passes_planned} passes done"
    return f"a drive of {found.duration_s / 60:.0f} min{where}{at}{of} was cut off"
