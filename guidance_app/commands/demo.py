"""``guidance-app demo``: the console on the embedded sample, at once."""

import argparse
import tempfile
from pathlib import Path

from guidance_app.commands.options import (
    add_console_options,
    add_filter_option,
    filter_settings,
    notices_of,
    replay_speed,
)
from guidance_app.commands.serving import serve
from guidance_app.runtime import ReplaySession
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_OPERATION, SAMPLE_RECORDING, Store, copy_sample, load_job

__all__ = ["add_parser", "run"]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "demo",
        help="see it drive: the embedded sample, played at once",
        description="Plays the embedded sample (a simulated job) on the console. It works on a temporary copy of the"
        " sample's data folder, which is removed at the end.",
    )
    add_filter_option(parser)
    parser.add_argument(
        "--speed", type=replay_speed, default=1.0, metavar="0.5..50|max", help="times real time (default 1)"
    )
    add_console_options(parser)
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Plays until stopped."""
    with tempfile.TemporaryDirectory(prefix="guidance-demo-") as folder:
        data = copy_sample(Path(folder))
        job = load_job(Store(data), SAMPLE_OPERATION)
        path = data / SAMPLE_RECORDING / "receiver.nmea"
        log = load_log(path)
        session = ReplaySession(
            job, log, arguments.filter, arguments.speed, notices_of(path), filter_settings(arguments.settings)
        )
        return serve(session, arguments, data, "playing the embedded sample, a simulated job")
