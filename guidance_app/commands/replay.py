"""``guidance-app replay``: a recorded log on the console."""

import argparse
from pathlib import Path

from guidance_app.commands.options import (
    UseError,
    add_console_options,
    add_data_option,
    add_job_options,
    chosen_data_folder,
    filter_settings,
    job_from_options,
    notices_of,
    replay_speed,
)
from guidance_app.commands.serving import serve
from guidance_app.runtime import ReplaySession
from guidance_app.sources.file import load_log

__all__ = ["add_parser", "run"]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "replay",
        help="play a receiver's log on the console",
        description="Plays an NMEA log on the console: play, pause, speed, and a slider to any second. Without --field"
        " the passes lie beside the first straight stretch of the log.",
    )
    parser.add_argument("log", type=Path, metavar="LOG", help="NMEA log, plain or .gz")
    add_job_options(parser)
    parser.add_argument(
        "--speed", type=replay_speed, default=1.0, metavar="0.5..50|max", help="times real time (default 1)"
    )
    add_data_option(parser)
    add_console_options(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Plays until stopped."""
    log = load_log(arguments.log)
    if not log.has_fix:
        msg = f"{arguments.log} holds no position fix, nothing can be shown: see guidance-app inspect"
        raise UseError(msg)
    data = chosen_data_folder(arguments)
    session = ReplaySession(
        job_from_options(arguments),
        log,
        arguments.filter,
        arguments.speed,
        notices_of(arguments.log),
        filter_settings(arguments.settings),
    )
    return serve(session, arguments, data, f"replaying {arguments.log} ({log.duration:.0f} s)")
