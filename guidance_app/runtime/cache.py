"""The user's cache folder: where it is, what writes into it, and which program it is good for.

A cache is never part of a recording: what comes from elsewhere (a backup, a bug report) brings none along, as reading
one runs what is written in it.
"""

import os
import pickle
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import MappingProxyType
from typing import Any

from platformdirs import user_cache_dir

__all__ = ["CachePickler", "cache_folder", "keep_newest", "program_now"]

ENVIRONMENT_NAME = "GUIDANCE_CACHE"
PACKAGE = Path(__file__).resolve().parent.parent


def cache_folder() -> Path:
    """Where indexes and resume points are kept: GUIDANCE_CACHE, else the user's cache folder."""
    named = os.environ.get(ENVIRONMENT_NAME, "")
    return Path(named) if named else Path(user_cache_dir("guidance-app", appauthor=False)) / "indexes"


def keep_newest(folder: Path, pattern: str, count: int) -> None:
    """Takes away the files of this pattern but the newest ``count``. Raises ``OSError``."""
    for old in sorted(folder.glob(pattern), key=lambda one: one.stat().st_mtime, reverse=True)[count:]:
        old.unlink(missing_ok=True)


class CachePickler(pickle.Pickler):
    """Knows read-only mappings too."""

    def reducer_override(self, held: object) -> Any:
        """How a mapping is made again; everything else as usual."""
        return (_read_only, (dict(held),)) if isinstance(held, MappingProxyType) else NotImplemented


def _read_only(members: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(members)


def program_now() -> list[str]:
    """This program as it is: its sources, and what computes with it."""
    sources = [f"{path.relative_to(PACKAGE)} {path.stat().st_mtime_ns}" for path in sorted(PACKAGE.rglob("*.py"))]
    return [sys.version, *(f"{name} {_version(name)}" for name in ("numpy", "numba", "shapely", "pyproj")), *sources]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
