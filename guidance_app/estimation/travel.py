"""Which way the tractor travels, from the fixes alone: a heading over a baseline of at least one metre.

Used by the filters that have no model of their own for the heading. A baseline that turns by more than 110 degrees
between two looks is a tractor that backs up, not one that turns: at the tightest radius of 0.5 m a metre turns it by
115 degrees only if it never straightens. Backing for more than 30 m is not believed; the tractor then goes forward.
Places are medians of three fixes, so that one outlier is neither a baseline nor a reversal.
"""

from dataclasses import dataclass, field

from guidance_app.estimation.observation_kernels import NO_COURSE
from guidance_app.estimation.travel_kernels import KEPT, REVERSE, WAY_HEADING, nothing_driven, travelled
from guidance_app.model import FloatArray

__all__ = ["Travel"]


@dataclass(frozen=True, slots=True, eq=False)
class Travel:
    """The last metre driven, the heading it gives, and whether the tractor backs up: ``travel_kernels``' memory."""

    memory: FloatArray = field(default_factory=nothing_driven)

    def to(self, east: float, north: float, compass: float | None = None) -> "Travel":
        """After one more fix. ``compass`` is a measured heading of the body; it decides which way is forward."""
        memory = self.memory.copy()
        travelled(memory, east, north, NO_COURSE if compass is None else compass)
        return Travel(memory)

    @property
    def heading(self) -> float | None:
        """The body's heading; None before a metre has been driven."""
        heading = float(self.memory[WAY_HEADING])
        return None if heading == NO_COURSE else heading

    @property
    def reverse(self) -> bool:
        """Whether the tractor backs up."""
        return bool(self.memory[REVERSE] == 1.0)

    @property
    def kept(self) -> int:
        """How many places are remembered."""
        return int(self.memory[KEPT])
