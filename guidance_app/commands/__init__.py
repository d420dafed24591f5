"""The sub-commands of ``guidance-app``, one a module with ``add_parser`` and ``run``; only they and ``cli`` print."""

from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["COMMANDS"]

COMMANDS: Mapping[str, str] = MappingProxyType(
    {
        name: f"guidance_app.commands.{name}"
        for name in ("demo", "run", "replay", "inspect", "process", "plan", "evaluate", "tune", "sample", "bench")
    }
)
"""Name -> module, in the order of the help."""
