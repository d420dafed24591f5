"""Corner lists in XLSX, XLS and ODS, by python-calamine. The first sheet that holds corners counts."""

import io
import zipfile

from python_calamine import CalamineError, CalamineWorkbook

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.exchange.asking import OpenQuestionError, ReadOptions, briefly
from guidance_app.exchange.corner_table import Cell, draft_corners
from guidance_app.exchange.files import MAX_UNPACKED, MEGABYTE, Files
from guidance_app.language import sentence

__all__ = ["read"]

MOST_CELLS = 2_000_000


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:
    """The fields of a spreadsheet. Raises ``BoundaryError``."""
    content = files.content()
    _check_unpacked(content)
    try:
        workbook = CalamineWorkbook.from_filelike(io.BytesIO(content))
        sheets = [(name, _cells(workbook, name)) for name in workbook.sheet_names]
    except (CalamineError, OSError, ValueError) as error:
        msg = sentence("it is not a sound spreadsheet ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error
    reasons = []
    for name, rows in sheets:
        said = [f"of {len(sheets)} sheets '{name}' is taken"] if len(sheets) > 1 else []
        try:
            return draft_corners(rows, options, files.title, said)
        except OpenQuestionError:
            raise
        except BoundaryError as error:
            reasons.append((rows, error))
    filled = [error for rows, error in reasons if rows]
    if not filled:
        msg = sentence("its sheets are empty")
        raise BoundaryError(msg)
    raise filled[0]


def _check_unpacked(content: bytes) -> None:
    """XLSX and ODS are archives: what they unpack to is bounded before they are opened."""
    if not content.startswith(b"PK"):
        return
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            total = sum(one.file_size for one in archive.infolist())
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        msg = sentence("it is not a sound spreadsheet ({reason})", reason=briefly(error))
        raise BoundaryError(msg) from error
    if total > MAX_UNPACKED:
        msg = sentence(
            "the spreadsheet unpacks to {size:,.0f} MB; {most} MB are the most",
            size=total / MEGABYTE,
            most=MAX_UNPACKED // MEGABYTE,
        )
        raise BoundaryError(msg)


def _cells(workbook: CalamineWorkbook, name: str) -> list[list[Cell]]:
    sheet = workbook.get_sheet_by_name(name)
    if sheet.total_height * sheet.total_width > MOST_CELLS:
        msg = sentence(
            "its sheet '{name}' has more than {most:,} cells, which no list of corners has", name=name, most=MOST_CELLS
        )
        raise BoundaryError(msg)
    return [[_cell(cell) for cell in row] for row in sheet.to_python(skip_empty_area=True)]


def _cell(value: object) -> Cell:
    """Numbers stay numbers; a date or a Boolean is no coordinate and becomes its text."""
    if isinstance(value, bool):
        return str(value)
    if isinstance(value, int | float):
        return float(value)
    return None if value is None or value == "" else str(value)
