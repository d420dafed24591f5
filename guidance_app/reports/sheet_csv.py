"""The ledger as a table of text: one row a drive, semicolons and a comma in numbers where the language has it."""

import csv
import io
from collections.abc import Sequence

from guidance_app.language import Words
from guidance_app.reports.ledger import Cell, LedgerEntry, columns, heading_of, row_of

__all__ = ["written"]

BYTE_ORDER_MARK = "\ufeff"
"""Spreadsheets read UTF-8 only with it."""


def written(entries: Sequence[LedgerEntry], title: str, words: Words) -> bytes:
    """The file. The title is not in it: a table has headings alone."""
    del title
    text = io.StringIO()
    comma = words.number(0.5, 1)[1] == ","
    table = csv.writer(text, delimiter=";" if comma else ",", lineterminator="\r\n")
    table.writerow([heading_of(name, unit, words) for name, unit in columns()])
    for entry in entries:
        table.writerow([_cell(cell, words) for cell in row_of(entry)])
    return (BYTE_ORDER_MARK + text.getvalue()).encode()


def _cell(cell: Cell, words: Words) -> str:
    if cell is None:
        return ""
    if isinstance(cell, str):
        # a leading sign would make a spreadsheet take a name for a formula
        return f"'{cell}" if cell[:1] in ("=", "+", "-", "@", "\t") else cell
    return str(cell) if isinstance(cell, int) else words.number(cell, 3)
