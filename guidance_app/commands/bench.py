"""``guidance-app bench``: measurements, as ratios within one run where a peer or a second size exists."""

import argparse
import importlib

from guidance_app.bench.rows import shown

__all__ = ["add_parser", "run"]

BENCHES = ("engine", "growth", "latency", "filters", "plan", "recording", "review")


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command; each bench describes itself."""
    parser = subparsers.add_parser(
        "bench",
        help="measure speed, growth and delay, as ratios",
        description="Measures the program on this machine. Each bench prints a table, or rows with --json.",
    )
    parser.set_defaults(func=run)
    benches = parser.add_subparsers(title="benches", metavar="BENCH", required=True)
    for name in BENCHES:
        importlib.import_module(f"guidance_app.bench.{name}").add_parser(benches)


def run(arguments: argparse.Namespace) -> int:
    """Prints the rows of the chosen bench."""
    print(shown(arguments.rows(arguments), as_json=arguments.json))
    return 0
