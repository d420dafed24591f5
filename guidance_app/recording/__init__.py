"""Drives as they are recorded: the inputs of an engine as lines of text, and what a recording says of itself."""

from guidance_app.recording.drive import RecordedDrive, RecordingMeta
from guidance_app.recording.lines import FORMAT, Lines, LineWriter, RecordingError, read_lines

__all__ = ["FORMAT", "LineWriter", "Lines", "RecordedDrive", "RecordingError", "RecordingMeta", "read_lines"]
