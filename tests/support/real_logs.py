"""What is stored of the real logs, and how it is made again: ``python -m support.real_logs`` in ``tests``.

Rewriting the golden file is a visible act: its difference shows in the commit what a change of decoding did.
"""

import json
from pathlib import Path

from guidance_app.batch.inspection import inspect, json_of
from guidance_app.sources.file import load_log

__all__ = ["GOLDEN_FILE", "logs_in", "summary_of"]

TESTS = Path(__file__).parents[1]
GOLDEN_FILE = TESTS / "golden" / "real_logs.json"
SUFFIXES = (".log", ".nmea", ".gga")
STORED = (
    "sentences",
    "decoded",
    "rejected",
    "fixes",
    "no_fixes",
    "attitudes",
    "interval_s",
    "duration_s",
    "length_m",
    "grid_m",
    "quality",
)


def logs_in(nmea: Path) -> dict[str, Path]:
    """Every receiver log below the folder, by its path there."""
    found = sorted(path for path in nmea.rglob("*") if path.suffix in SUFFIXES)
    return {path.relative_to(nmea).as_posix(): path for path in found}


def summary_of(path: Path) -> dict[str, object]:
    """What is stored of a log."""
    found = json_of(inspect(load_log(path)))
    return {name: found[name] for name in STORED}


def _rewrite() -> None:
    logs = logs_in(TESTS.parent.parent / "shared" / "data" / "nmea")
    golden = {name: summary_of(path) for name, path in logs.items()}
    GOLDEN_FILE.write_text(json.dumps(golden, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    _rewrite()
