"""``guidance-app replay``: a recorded drive, or a receiver's log, on the console."""

import argparse
from pathlib import Path

from guidance_app.commands.options import (
    UseError,
    add_compare_options,
    add_console_options,
    add_data_option,
    add_job_options,
    chosen_data_folder,
    comparison,
    filter_settings,
    job_from_options,
    notices_of,
    refuse_documents,
    replay_speed,
)
from guidance_app.commands.serving import serve
from guidance_app.runtime import ReplaySession, cache_folder
from guidance_app.sources.file import load_log
from guidance_app.store.recordings import is_recording, open_recording

__all__ = ["add_parser", "run"]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "replay",
        help="play a recorded drive or a receiver's log on the console",
        description="Plays a recorded drive, or an NMEA log, on the console: play, pause, speed, and a slider to any"
        " second. A recording (its folder, or a zip of it) is driven with its own documents and filter. A log without"
        " --field has its passes beside its first straight stretch.",
    )
    parser.add_argument(
        "log", type=Path, metavar="RECORDING", help="folder or zip of a recording; NMEA log, plain or .gz"
    )
    add_job_options(parser)
    add_compare_options(parser)
    parser.add_argument(
        "--speed", type=replay_speed, default=1.0, metavar="0.5..50|max", help="times real time (default 1)"
    )
    add_data_option(parser)
    add_console_options(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Plays until stopped."""
    data = chosen_data_folder(arguments)
    session = _of_recording(arguments) if is_recording(arguments.log) else _of_log(arguments)
    session.make_index(cache_folder())
    return serve(session, arguments, data, f"replaying {arguments.log} ({session.replay.state.duration:.0f} s)")


def _of_recording(arguments: argparse.Namespace) -> ReplaySession:
    refuse_documents(arguments, "filter", "settings")
    drive = open_recording(arguments.log)
    if drive.truncated is not None:
        print(drive.truncated)
    if not len(drive.events):
        msg = f"{arguments.log} holds no event, nothing can be shown"
        raise UseError(msg)
    return ReplaySession.of_drive(drive, arguments.speed, comparison(arguments, drive.job))


def _of_log(arguments: argparse.Namespace) -> ReplaySession:
    log = load_log(arguments.log)
    if not log.has_fix:
        msg = f"{arguments.log} holds no position fix, nothing can be shown: see guidance-app inspect"
        raise UseError(msg)
    job = job_from_options(arguments)
    return ReplaySession(
        job,
        log,
        arguments.filter,
        arguments.speed,
        notices_of(arguments.log),
        filter_settings(arguments.settings),
        compare=comparison(arguments, job),
    )
