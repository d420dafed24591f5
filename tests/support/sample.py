"""What the decoder makes of a log."""

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Observation
from guidance_app.sources.file import FileLog


def observations_of(log: FileLog) -> list[Observation]:
    """Every observation of the log, in order; nothing of it may be rejected."""
    decoder = Decoder()
    found: list[Observation] = []
    for chunk in log.chunks:
        found += decoder.feed(chunk)
    found += decoder.finish(log.duration)
    assert decoder.rejected == {}
    return found
