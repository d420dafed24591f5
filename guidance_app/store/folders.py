"""Where the data folder is, and the embedded sample that the program brings along."""

import json
import shutil
from collections.abc import Mapping
from pathlib import Path

from platformdirs import user_data_dir

from guidance_app.language import message, sentence
from guidance_app.store.files import StoreError, read_bounded, why

__all__ = ["SAMPLE_OPERATION", "SAMPLE_RECORDING", "copy_sample", "data_folder", "sample_folder", "simulated_notice"]

PACKAGE = Path(__file__).resolve().parent.parent
ENVIRONMENT_NAME = "GUIDANCE_DATA"
SAMPLE_RECORDING = Path("recordings") / "sample"
"""The embedded recording's folder inside a data folder."""
SAMPLE_OPERATION = "Round trip"
"""The name of the operation that the embedded recording drives."""
SESSION_NAME = "session.json"
"""What is known of a recording, beside its log."""
_SAMPLE = (
    Path("fields") / "sample-field",
    Path("tractors") / "sample-tractor.json",
    Path("implements") / "sample-implement.json",
    Path("receivers") / "sample-receiver.json",
    SAMPLE_RECORDING,
)


def data_folder(argument: Path | None, environment: Mapping[str, str]) -> Path:
    """The data folder: ``argument`` (of ``--data``), GUIDANCE_DATA, ``fields/`` of the checkout or the user's data.

    Raises ``StoreError`` when a file is in its place; nothing is created.
    """
    named = environment.get(ENVIRONMENT_NAME, "")
    if argument is not None:
        folder = argument
    elif named:
        folder = Path(named)
    else:
        folder = _checkout_folder() or Path(user_data_dir("guidance-app", appauthor=False))
    folder = folder.expanduser().absolute()
    if folder.exists() and not folder.is_dir():
        msg = sentence(
            "the data folder {folder} is a file; name a folder with --data or {environment_name}",
            folder=folder,
            environment_name=ENVIRONMENT_NAME,
        )
        raise StoreError(msg)
    return folder


def sample_folder() -> Path:
    """Where the embedded sample lies: in the checkout, or inside an installed package. Raises ``StoreError``."""
    for folder in (PACKAGE.parent / "fields", PACKAGE / "_fields"):
        if (folder / SAMPLE_RECORDING).is_dir():
            return folder
    msg = sentence("the embedded sample is missing beside {package}; install the program again", package=PACKAGE)
    raise StoreError(msg)


def simulated_notice(log: Path) -> str | None:
    """What a screen must say beside this log, because its ``session.json`` says that it is simulated; else None."""
    try:
        members = json.loads(read_bounded(log.with_name(SESSION_NAME)))
    except (OSError, ValueError, RecursionError, StoreError):
        return None  # most logs have no such file beside them, and a broken one cannot make a log simulated
    if not isinstance(members, dict) or members.get("simulated") is not True:
        return None
    notice = members.get("notice")
    return notice if isinstance(notice, str) and notice else message("This recording is simulated.")


def copy_sample(to: Path) -> Path:
    """Copies the embedded sample, and nothing else that lies beside it, into ``to``. Raises ``StoreError``."""
    source = sample_folder()
    try:
        for part in _SAMPLE:
            target = to / part
            target.parent.mkdir(parents=True, exist_ok=True)
            if (source / part).is_dir():
                shutil.copytree(source / part, target, dirs_exist_ok=True)
            else:
                shutil.copyfile(source / part, target)
    except OSError as error:
        msg = sentence("the sample cannot be copied to {to}: {reason}", to=to, reason=why(error))
        raise StoreError(msg) from error
    return to


def _checkout_folder() -> Path | None:
    """``fields/`` beside the package when the program runs from a checkout."""
    root = PACKAGE.parent
    return root / "fields" if (root / "pyproject.toml").is_file() and (root / "fields").is_dir() else None
