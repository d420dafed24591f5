"""``guidance-app run``: the console on a live source."""

import argparse

from guidance_app.commands.options import (
    add_console_options,
    add_data_option,
    add_job_options,
    chosen_data_folder,
    filter_settings,
    job_from_options,
)
from guidance_app.commands.serving import serve
from guidance_app.runtime import LiveSession
from guidance_app.sources import SOURCES, open_source

__all__ = ["add_parser", "run"]


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
    add_job_options(parser)
    add_data_option(parser)
    add_console_options(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Drives until stopped."""
    data = chosen_data_folder(arguments)
    if arguments.source is None:
        return serve(None, arguments, data, "nothing is driven yet: choose at the screen")
    source = open_source(arguments.source)
    session = LiveSession(job_from_options(arguments), source, arguments.filter, filter_settings(arguments.settings))
    return serve(session, arguments, data, f"reading {source.description}")
