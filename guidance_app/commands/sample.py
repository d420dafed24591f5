"""``guidance-app sample``: makes the embedded sample again, its documents and its simulated recording."""

import argparse
import json
from pathlib import Path

import numpy as np

from guidance_app.documents import Job
from guidance_app.language import message
from guidance_app.model import SegmentKind
from guidance_app.simulation.job import JobSettings, LossOfFix, SimulatedEpoch, simulated_epochs
from guidance_app.simulation.sample import sample_job
from guidance_app.sources.simulated import sample_drive
from guidance_app.store import SAMPLE_RECORDING, Store, write_file

__all__ = ["add_parser", "run", "sample_log"]

SEED = 20130
"""Of the sample that the project brings along."""
LOG_NAME = "receiver.nmea"
SETTINGS = JobSettings(start_right=0.5, loss=LossOfFix(pass_number=4, seconds=8.0))


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "sample",
        help="make the embedded sample again",
        description="Makes the embedded sample: an invented field, tractor, implement, receiver and operation, and the"
        " recording of a simulated job on it. The same seed gives the same bytes.",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder that the sample is written to")
    parser.add_argument("--seed", type=_seed, default=SEED, help=f"of the random errors (default {SEED})")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Writes the sample and says what it is."""
    job = sample_job()
    epochs, log = sample_log(job, arguments.seed)
    _write_documents(Store(arguments.out), job)
    recording = arguments.out / SAMPLE_RECORDING
    write_file(arguments.out, recording / LOG_NAME, log)
    write_file(arguments.out, recording / "session.json", _session(job, arguments.seed, epochs))
    passes = {each.number for each in epochs if each.kind is SegmentKind.PASS}
    print(f"{recording / LOG_NAME}: simulated, {len(passes)} passes, {epochs[-1].t / 60:.1f} min, {len(log):,} bytes")
    return 0


def sample_log(job: Job, seed: int) -> tuple[list[SimulatedEpoch], bytes]:
    """The epochs of the simulated job, and the log that a receiver would have left of them."""
    drive = sample_drive(job)
    epochs = list(
        simulated_epochs(drive.passes, (job.tractor, job.implement), drive.frame, SETTINGS, np.random.default_rng(seed))
    )
    head = (
        "# This log is SIMULATED: no receiver and no tractor were involved.\r\n"
        f"# Made by: guidance-app sample --seed {seed}\r\n"
    )
    return epochs, head.encode("ascii") + b"".join(each.data for each in epochs)


def _write_documents(store: Store, job: Job) -> None:
    for document in (job.field, job.tractor, job.implement, job.receiver, job.operation):
        if document is not None:
            store.replace(document)


def _session(job: Job, seed: int, epochs: list[SimulatedEpoch]) -> bytes:
    members = {
        "schema_version": 1,
        "kind": "session",
        "name": "Sample recording",
        "simulated": True,
        "notice": message("Simulated: an invented tractor on an invented field."),
        "log": LOG_NAME,
        "operation": job.operation.name if job.operation is not None else None,
        "field": job.field.name if job.field is not None else None,
        "started_utc": f"{SETTINGS.start:%Y-%m-%dT%H:%M:%SZ}",
        "duration_s": epochs[-1].t,
        "seed": seed,
    }
    return (json.dumps(members, ensure_ascii=False, indent=1) + "\n").encode()


def _seed(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = -1
    if not 0 <= value < 2**32:
        msg = f"{text!r} is no seed; it is a whole number from 0 to {2**32 - 1}"
        raise argparse.ArgumentTypeError(msg)
    return value
