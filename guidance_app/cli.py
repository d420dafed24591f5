"""The command ``guidance-app``: parses, dispatches to ``commands``, and turns a known error into one line.

Exit status: 0 done, 1 a check failed, 2 bad input or use, 130 stopped by Ctrl-C.
"""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

from guidance_app import __version__
from guidance_app.commands import COMMANDS
from guidance_app.commands.options import known_errors

__all__ = ["main"]


def parser() -> argparse.ArgumentParser:
    """The whole command line. Each sub-command is a module of ``commands`` and describes itself."""
    top = argparse.ArgumentParser(
        prog="guidance-app",
        description="The guidance console for tractors without autosteer: an ordinary receiver, any tablet's browser.",
        epilog="Start with: guidance-app demo",
    )
    top.add_argument("--version", action="version", version=f"guidance-app {__version__}")
    subparsers = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for module in COMMANDS.values():
        importlib.import_module(module).add_parser(subparsers)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command line; the exit status."""
    parsed = parser().parse_args(arguments)
    try:
        status: int = parsed.func(parsed)
        sys.stdout.flush()
    except known_errors() as error:
        print(f"guidance-app: {_one_line(error)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        # The reader of our output has gone (guidance-app inspect ... | head): nothing is left to say to it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    return status


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split())
