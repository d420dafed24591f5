"""What a browser is told of each kind of sheet."""

__all__ = ["MEDIA_TYPES"]

MEDIA_TYPES = {
    ".pdf": "application/pdf",
    ".csv": "text/csv",
    ".xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
}
"""By ending."""
