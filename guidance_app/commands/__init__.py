"""The sub-commands of ``guidance-app``, one a module with ``add_parser`` and ``run``; only they and ``cli`` print."""

from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["COMMANDS"]

COMMANDS: Mapping[str, str] = MappingProxyType(
    {
        "demo": "see it drive: the embedded sample, played at once",
        "run": "drive: the console on a live receiver",
        "replay": "play a recorded drive or a receiver's log on the console",
        "inspect": "say what a receiver's log holds",
        "process": "run logs and recordings through the engine without a screen and write tables",
        "ledger": "write the sheet to hand in: what was worked where, when and how well",
        "export": "write a drive for other programs",
        "convert": "look into field files and time logs of other programs, and convert them",
        "report": "pack a recording for a bug report, at its place or moved elsewhere",
        "plan": "plan a field's passes at the desk",
        "evaluate": "repeat the papers' protocols and the scenarios, beside the goals",
        "tune": "fit the filters to simulated or recorded drives",
        "sample": "make the embedded sample again",
        "bench": "measure speed, growth and delay, as ratios",
    }
)
"""Name (and module) -> its line in the help, in the order of the help. Only the module that is asked for is loaded."""
