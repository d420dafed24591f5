"""``guidance-app report``: a recording as one zip for a bug report, at its place or moved elsewhere on earth."""

import argparse
from pathlib import Path

import numpy as np

from guidance_app.commands.options import UseError
from guidance_app.recording.moving import possible_moves
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_report import write_report

__all__ = ["add_parser", "run"]


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "report",
        help="pack a recording for a bug report",
        description="Writes one zip of a recording, which replays on any machine as it did on this one. It holds the"
        " documents in use and all that the receiver said, but no password. --move shifts everything by whole degrees"
        " of longitude that are drawn by chance: lengths and angles stay; latitude, times, the shape of the field and"
        " all names stay too, so it hides the place from a glance, not from a search.",
    )
    parser.add_argument("recording", type=Path, metavar="RECORDING", help="folder or zip of a recording")
    parser.add_argument("--out", type=Path, required=True, metavar="ZIP", help="file to write")
    parser.add_argument("--move", action="store_true", help="somewhere else on earth")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the file whole or not at all."""
    if arguments.out.suffix.lower() != ".zip":
        msg = f"{arguments.out}: a report is a .zip"
        raise UseError(msg)
    drive = open_recording(arguments.recording)
    if not len(drive.events):
        msg = f"{arguments.recording} holds no event, there is nothing to report"
        raise UseError(msg)
    move = int(np.random.default_rng().choice(possible_moves(drive.job))) if arguments.move else None
    written = write_report(drive, arguments.out, move)
    print(f"{arguments.out}: {written.events} events of {drive.duration:.0f} s, {written.size / 1e6:.1f} MB")
    if written.blanked is not None:
        print(f"moved elsewhere; {written.blanked} sentences were not understood and lost their digits")
    if drive.truncated is not None:
        print(drive.truncated)
    return 0
