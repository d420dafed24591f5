"""The rows of a bench: what was measured, in which unit, what was asked; as a table or as JSON."""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

__all__ = ["Row", "add_json_option", "shown"]


@dataclass(frozen=True, slots=True)
class Row:
    """One measured number. ``asked`` is the bound in words, empty where the number only informs."""

    bench: str
    quantity: str
    value: float
    unit: str
    asked: str = ""
    note: str = ""


def add_json_option(parser: argparse.ArgumentParser) -> None:
    """``--json``."""
    parser.add_argument("--json", action="store_true", help="print rows as JSON instead of a table")


def shown(rows: Sequence[Row], *, as_json: bool) -> str:
    """The rows as text for a terminal, or as a JSON list."""
    if as_json:
        return json.dumps([asdict(row) for row in rows], indent=1)
    cells = [("quantity", "value", "unit", "asked", "note")]
    cells += [(row.quantity, f"{row.value:.4g}", row.unit, row.asked, row.note) for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(5)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in cells]
    return "\n".join(lines)
