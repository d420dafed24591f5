"""The command ``guidance-app``: parses, dispatches to ``commands``, and turns a known error into one line.

Exit status: 0 done, 1 a check failed, 2 bad input or use, 130 stopped by Ctrl-C, 141 whoever read the output has gone.
"""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

from guidance_app import __version__
from guidance_app.commands import COMMANDS

__all__ = ["main"]


def parser(wanted: str | None) -> argparse.ArgumentParser:
    """The command line. Each sub-command is a module of ``commands`` and describes itself; only ``wanted`` loads."""
    top = argparse.ArgumentParser(
        prog="guidance-app",
        description="The guidance console for tractors without autosteer: an ordinary receiver, any tablet's browser.",
        epilog="Start with: guidance-app demo",
    )
    top.add_argument("--version", action="version", version=f"guidance-app {__version__}")
    subparsers = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, line in COMMANDS.items():
        if name == wanted:
            importlib.import_module(f"guidance_app.commands.{name}").add_parser(subparsers)
        else:
            subparsers.add_parser(name, help=line)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command line; the exit status."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    wanted = next((one for one in given if not one.startswith("-")), None)
    parsed = parser(wanted).parse_args(given)
    try:
        status: int = parsed.func(parsed)
        sys.stdout.flush()
    except BrokenPipeError:
        # guidance-app inspect ... | head: nothing is left to say, neither now nor when the interpreter flushes.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except Exception as error:
        if not _is_known(error):
            raise
        print(f"guidance-app: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return status


def _is_known(error: Exception) -> bool:
    """Whether its message is a sentence for the person at the terminal."""
    from guidance_app.commands.options import known_errors  # noqa: PLC0415 - loads much that the help does not need

    return isinstance(error, known_errors())
