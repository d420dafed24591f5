"""What comes over a session's links, decoded: the part of a step that needs nothing of the rest.

So it can also be done beforehand, elsewhere, and given to the engine with each event (see ``decoding_beside``).
"""

from dataclasses import dataclass

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Chunk, Observation, Satellite, SourceDown
from guidance_app.model.making import made_quickly

__all__ = ["Counts", "Heard", "Hearing"]

Counts = tuple[int, int, int]
"""What a link's decoder has counted: sentences seen, lines and epochs rejected, sentences read."""


@made_quickly
@dataclass(frozen=True, slots=True)
class Heard:
    """What one event closed, and what its link's decoder had counted and seen of the sky by then."""

    closed: tuple[Observation, ...]
    counts: Counts
    sky: tuple[Satellite, ...]


class Hearing:
    """A decoder for each link."""

    def __init__(self) -> None:
        self._decoders: dict[str, Decoder] = {}

    def fork(self) -> "Hearing":
        """An independent copy."""
        other = Hearing()
        other._decoders = {link: one.fork() for link, one in self._decoders.items()}
        return other

    def hear(self, event: Chunk | SourceDown) -> Heard:
        """What these bytes, or the end of them, close."""
        decoder = self._decoders.get(event.link)
        if decoder is None:
            decoder = self._decoders[event.link] = Decoder(event.link)
        closed = decoder.feed(event) if isinstance(event, Chunk) else decoder.finish(event.arrival)
        counts = (decoder.sentences, sum(decoder.rejected.values()), sum(decoder.kinds.values()))
        return Heard(closed, counts, decoder.sky)

    @property
    def close_epoch(self) -> Chunk | None:
        """The empty chunk that closes the half-received epoch which waits longest; None when there is none."""
        waiting = [(one.wake_at, link) for link, one in self._decoders.items() if one.wake_at is not None]
        if not waiting:
            return None
        at, link = min(waiting)
        return Chunk(at, b"", link)
