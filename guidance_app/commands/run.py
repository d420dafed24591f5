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
        description=f"Opens the console on a live source. Sources: {known}",
    )
    parser.add_argument("--source", required=True, metavar="URI", help=f"where the bytes come from: {known}")
    add_job_options(parser)
    add_data_option(parser)
    add_console_options(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Drives until stopped."""
    source = open_source(arguments.source)
    data = chosen_data_folder(arguments)
    session = LiveSession(job_from_options(arguments), source, arguments.filter, filter_settings(arguments.settings))
    return serve(session, arguments, data, f"reading {source.description}")
