"""Recordings from elsewhere, from an upload's bytes: a recording's zip, or an ISOXML archive with time logs."""

from pathlib import Path

from guidance_app.batch.time_logs import field_of, job_of, recording_of
from guidance_app.exchange import ExchangeError
from guidance_app.exchange.time_log_drive import read_time_log, time_log_names
from guidance_app.language import sentence
from guidance_app.store.files import StoreError
from guidance_app.store.recordings import is_recording_zip
from guidance_app.store.recordings_keeping import take_in_recording

__all__ = ["taken_in"]


def taken_in(data: Path, content: bytes, name: str) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """The folders of what was kept, and what is to be known of it, a sentence each.

    Each time log of an ISOXML archive becomes a recording of its own; one that cannot be read is left out and told.
    Raises ``StoreError`` when there is nothing that can be kept.
    """
    if is_recording_zip(content):
        return (take_in_recording(data, content, name),), ()
    try:
        logs = time_log_names(content, name)
    except ExchangeError as error:
        msg = sentence(
            "{name} is no recording, and not ISOXML task data either: {reason}", name=name, reason=error.args[0]
        )
        raise StoreError(msg) from error
    if not logs:
        msg = sentence("{name}: there is no time log in it whose two files are both there", name=name)
        raise StoreError(msg)
    return _of_time_logs(data, content, name, logs)


def _of_time_logs(
    data: Path, content: bytes, name: str, logs: tuple[str, ...]
) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    folders: list[Path] = []
    told: list[str] = []
    for each in logs:
        try:
            log = read_time_log(content, each, name)
            zipped = recording_of(log, job_of(log, field_of(content, log, name=name)))
            folders.append(take_in_recording(data, zipped, f"{name} {each}"))
        except (ExchangeError, StoreError) as error:
            told.append(sentence("The time log {log} was left out: {reason}", log=each, reason=error.args[0]))
        else:
            told += log.warnings
    if not folders:
        raise StoreError(told[0])
    return tuple(folders), tuple(dict.fromkeys(told))
