"""A receiver's log that was driven round a field: its positions are the boundary."""

from guidance_app.boundary import BoundaryError, FieldDraft
from guidance_app.decode.decoder import Decoder
from guidance_app.exchange.asking import ReadOptions
from guidance_app.exchange.files import Files
from guidance_app.exchange.rings import ring_of_track
from guidance_app.language import sentence
from guidance_app.model import Chunk, Fix

__all__ = ["read"]


def read(files: Files, options: ReadOptions) -> tuple[FieldDraft, ...]:  # noqa: ARG001 - a log leaves nothing open
    """The ring that was driven. Raises ``BoundaryError``."""
    decoder = Decoder()
    seen = (*decoder.feed(Chunk(0.0, files.content())), *decoder.finish(0.0))
    track = [(fix.longitude_deg, fix.latitude_deg) for fix in seen if isinstance(fix, Fix)]
    if not track:
        msg = sentence("it holds no position of a receiver")
        raise BoundaryError(msg)
    ring, remarks = ring_of_track(track)
    said = (sentence("the track of the antenna is taken as the boundary"),)
    return (FieldDraft(name=None, parts=([ring],), remarks=remarks, assumptions=said),)
