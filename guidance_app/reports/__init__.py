"""What is said of a drive afterwards: how well each pass was driven, and the ledger's sheets. Pure; nothing is read.

``SHEETS`` is the table of the ledger's formats, one a file; each takes entries and gives the bytes of a file.
"""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from guidance_app.language import Words
from guidance_app.reports import sheet_csv, sheet_pdf, sheet_xlsx
from guidance_app.reports.ledger import LedgerEntry, ledger_entry
from guidance_app.reports.quality import PassQuality, pass_qualities

__all__ = ["SHEETS", "LedgerEntry", "PassQuality", "Sheet", "ledger_entry", "pass_qualities"]

Sheet = Callable[[Sequence[LedgerEntry], str, Words], bytes]
"""Entries, the title, and the words of the sheet's language."""

SHEETS: Mapping[str, Sheet] = MappingProxyType(
    {".pdf": sheet_pdf.written, ".xlsx": sheet_xlsx.written, ".csv": sheet_csv.written}
)
