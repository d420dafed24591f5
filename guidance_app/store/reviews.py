"""The columns of recordings, kept beside them so that looking back takes a moment; they can always be made anew.

What is kept is named by the recording's files as they lie and by this program's version: another program makes it
anew, and a kept file that is damaged is made anew too. What was not used for longest goes when there is too much.
"""

import hashlib
import json
import os
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from guidance_app import __version__
from guidance_app.model import CoverageTotals, DriveLog
from guidance_app.store.recordings import RecordingFiles

__all__ = ["KEPT", "KeptColumns", "keep_columns", "kept_columns", "place_of"]

KEPT = Path(".derived") / "reviews"
LAYOUT = 2
"""Of a kept file; changes with the columns."""
MOST_BYTES = 2_000_000_000
"""Of all that is kept: some thirty days of eight hours at 10 Hz."""


@dataclass(frozen=True, slots=True, eq=False)
class KeptColumns:
    """A recording's columns, what was worked in all, and whether it was whole."""

    log: DriveLog
    totals: CoverageTotals
    whole: bool


def place_of(data: Path, files: RecordingFiles) -> Path:
    """Where the columns of these contents are kept."""
    digest = hashlib.sha256(files.session + b"\0" + files.events).hexdigest()
    return data / KEPT / f"{digest[:40]}-{__version__}-{LAYOUT}.npz"


def kept_columns(place: Path) -> KeptColumns | None:
    """What was kept; None where there is nothing, or nothing that can be read."""
    if not place.is_file():
        return None
    try:
        with place.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            columns = {name: file[name] for name in DriveLog.columns()}
            facts = json.loads(str(file["facts"]))
            totals = CoverageTotals(**facts["totals"])
            origin, whole = facts["origin_deg"], bool(facts["whole"])
        os.utime(place)
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, EOFError):
        return None
    return KeptColumns(
        DriveLog(**columns, origin_deg=None if origin is None else (origin[0], origin[1])), totals, whole
    )


def keep_columns(place: Path, kept: KeptColumns) -> None:
    """Keeps the columns; where that cannot be, the next time takes as long again, and nothing else is lost."""
    log = kept.log
    facts = json.dumps({"totals": asdict(kept.totals), "origin_deg": log.origin_deg, "whole": kept.whole})
    columns = {name: getattr(log, name) for name in DriveLog.columns()}
    unfinished = place.with_name(place.name + ".part.npz")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        np.savez(unfinished, facts=np.array(facts), **columns)
        unfinished.replace(place)
        _bound(place.parent)
    except OSError:
        unfinished.unlink(missing_ok=True)


def _bound(folder: Path) -> None:
    """Takes away what was not used for longest, down to the bound."""
    left = MOST_BYTES
    for path in sorted(folder.glob("*.npz"), key=lambda one: one.stat().st_mtime, reverse=True):
        left -= path.stat().st_size
        if left < 0:
            path.unlink(missing_ok=True)
