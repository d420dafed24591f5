"""The rows of a bench: what was measured, in which unit, what was asked; as a table or as JSON."""

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import TypeAlias

__all__ = ["Row", "Subparsers", "add_bench", "add_hours", "shown"]


@dataclass(frozen=True, slots=True)
class Row:
    """One measured number. ``asked`` is the bound in words, empty where the number only informs."""

    bench: str
    quantity: str
    value: float
    unit: str
    asked: str = ""
    note: str = ""


Subparsers: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"  # noqa: SLF001 - it has no other name


def add_bench(
    subparsers: Subparsers, name: str, rows: Callable[[argparse.Namespace], Sequence[Row]], *, about: str, does: str
) -> argparse.ArgumentParser:
    """A bench with ``--json``, described in a line and in sentences; ``rows`` measures, as its arguments wish."""
    parser = subparsers.add_parser(name, help=about, description=does)
    parser.add_argument("--json", action="store_true", help="print rows as JSON instead of a table")
    parser.set_defaults(rows=rows)
    return parser


def add_hours(parser: argparse.ArgumentParser) -> None:
    """``--hours`` of the simulated day."""
    parser.add_argument("--hours", type=float, default=8.0, help="length of the day (default 8)")


def shown(rows: Sequence[Row], *, as_json: bool) -> str:
    """The rows as text for a terminal, or as a JSON list."""
    if as_json:
        return json.dumps([asdict(row) for row in rows], indent=1)
    cells = [("quantity", "value", "unit", "asked", "note")]
    cells += [(row.quantity, f"{row.value:.4g}", row.unit, row.asked, row.note) for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(5)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells]
    return "\n".join(lines)
