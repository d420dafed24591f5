"""The ledger as a printed sheet: one page a drive with its map, and the sums of several; written with ReportLab.

Names may be of any script: what is not Latin is set in a font that every reader of PDF brings along for Japanese,
which has Greek and Cyrillic too.
"""

import io
from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.cidfonts import UnicodeCIDFont
from reportlab.platypus import Flowable, Image, KeepTogether, PageBreak, Paragraph, SimpleDocTemplate, Spacer, Table

from guidance_app.language import Words
from guidance_app.reports.drawing import map_png
from guidance_app.reports.ledger import Cell, LedgerEntry, columns, heading_of, row_of, sums_of

__all__ = ["written"]

LATIN, LATIN_BOLD, OTHER = "Helvetica", "Helvetica-Bold", "HeiseiKakuGo-W5"
MAP_SIZE = 110 * mm
LABEL = 45 * mm
VALUE = 45 * mm


def written(entries: Sequence[LedgerEntry], title: str, words: Words) -> bytes:
    """The file's bytes."""
    pdfmetrics.registerFont(UnicodeCIDFont(OTHER))
    made = io.BytesIO()
    page = SimpleDocTemplate(
        made,
        pagesize=A4,
        leftMargin=15 * mm,
        rightMargin=15 * mm,
        topMargin=15 * mm,
        bottomMargin=15 * mm,
        title=title,
        invariant=True,
    )
    story: list[Flowable] = []
    for number, entry in enumerate(entries):
        if number:
            story.append(PageBreak())
        story.extend(_one(entry, title, words))
    if len(entries) > 1:
        story.extend([PageBreak(), *_sums(entries, title, words)])
    if not story:
        story.append(_line(words("Nothing was driven."), 12))
    page.build(story)
    return made.getvalue()


def _line(text: str, size: float, *, bold: bool = False) -> Paragraph:
    font = (LATIN_BOLD if bold else LATIN) if _is_latin(text) else OTHER
    return Paragraph(escape(text), ParagraphStyle("line", fontName=font, fontSize=size, leading=size * 1.3))


def _is_latin(text: str) -> bool:
    try:
        text.encode("latin-1")
    except UnicodeEncodeError:
        return False
    return True


def _one(entry: LedgerEntry, title: str, words: Words) -> Iterator[Flowable]:
    """One drive: its title, its table and its map on one page."""
    yield _line(title, 16, bold=True)
    yield _line(" · ".join(part for part in (entry.field, entry.operation) if part) or entry.name, 12)
    yield Spacer(1, 4 * mm)
    yield _table(tuple(row_of(entry)), words)
    yield Spacer(1, 4 * mm)
    yield KeepTogether([Image(io.BytesIO(map_png(entry)), MAP_SIZE, MAP_SIZE)])


def _sums(entries: Sequence[LedgerEntry], title: str, words: Words) -> Iterator[Flowable]:
    yield _line(title, 16, bold=True)
    yield _line(words("Sum of {count} drives", count=len(entries)), 12)
    yield Spacer(1, 4 * mm)
    yield _table(sums_of(entries), words)


def _table(cells: Sequence[Cell], words: Words) -> Table:
    """Two columns of names and values; what is unknown or was left empty is not there."""
    pairs = [
        (heading_of(name, unit, words), _said(cell, words))
        for (name, unit), cell in zip(columns(), cells, strict=True)
        if cell is not None and cell != ""
    ]
    half = (len(pairs) + 1) // 2
    left, right = pairs[:half], [*pairs[half:], ("", "")]
    rows = [
        [_line(a, 9), _line(b, 9, bold=True), _line(c, 9), _line(d, 9, bold=True)]
        for (a, b), (c, d) in zip(left, right, strict=False)
    ]
    table = Table(rows, colWidths=[LABEL, VALUE, LABEL, VALUE])
    table.setStyle(
        [
            ("LINEBELOW", (0, 0), (-1, -1), 0.25, colors.lightgrey),
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
            ("LEFTPADDING", (0, 0), (-1, -1), 2),
        ]
    )
    return table


def _said(cell: Cell, words: Words) -> str:
    match cell:
        case str():
            return cell
        case int():
            return str(cell)
        case _:
            return words.number(cell or 0.0, 2)
