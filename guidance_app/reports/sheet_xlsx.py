"""The ledger as a workbook: one row a drive with real numbers, sums below; written with XlsxWriter."""

import io
from collections.abc import Sequence

import xlsxwriter

from guidance_app.language import Words
from guidance_app.reports.drawing import map_png
from guidance_app.reports.ledger import LedgerEntry, columns, heading_of, row_of, sums_of

__all__ = ["written"]

WIDTHS = (24, 18, 18, 14, 16, 16)
PLAIN = 12
MAP_ROWS = 22
MAP_PIXELS = 420


def written(entries: Sequence[LedgerEntry], title: str, words: Words) -> bytes:
    """The workbook's bytes: a sheet with the table, and one with the maps."""
    made = io.BytesIO()
    with xlsxwriter.Workbook(made, {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False}) as book:
        bold = book.add_format({"bold": True, "text_wrap": True, "valign": "top", "bottom": 1})
        number = book.add_format({"num_format": "0.00"})
        total = book.add_format({"num_format": "0.00", "bold": True, "top": 1})
        sheet = book.add_worksheet(words("Ledger")[:31])
        sheet.write_string(0, 0, title, book.add_format({"bold": True, "font_size": 14}))
        for place, (name, unit) in enumerate(columns()):
            sheet.set_column(place, place, WIDTHS[place] if place < len(WIDTHS) else PLAIN)
            sheet.write_string(2, place, heading_of(name, unit, words), bold)
        for line, entry in enumerate(entries, start=3):
            for place, cell in enumerate(row_of(entry)):
                if isinstance(cell, str):
                    sheet.write_string(line, place, cell)
                elif cell is not None:
                    sheet.write_number(line, place, cell, number)
        for place, cell in enumerate(sums_of(entries)):
            if isinstance(cell, int | float):
                sheet.write_number(3 + len(entries), place, cell, total)
        sheet.freeze_panes(3, 1)
        maps = book.add_worksheet(words("Maps")[:31])
        for place, entry in enumerate(entries):
            maps.write_string(place * MAP_ROWS, 0, f"{entry.field} {entry.name}".strip(), bold)
            picture = io.BytesIO(map_png(entry, MAP_PIXELS))
            maps.insert_image(place * MAP_ROWS + 1, 0, f"map{place}.png", {"image_data": picture})
    return made.getvalue()
