"""The sentences of one instant, and the fix that they make together.

The position comes from the first of GGA, GNS, KSXT, PAOGI, PANDA, RMC, GLL that is there; what it does not say comes
from the others. A GGA that leaves its quality empty (some do) is believed when the RMC or GLL beside it says valid.
A sentence of the first five that says "no fix" outweighs an RMC that says valid. Two GGA are two antennas.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from guidance_app.angles import wrap_2pi
from guidance_app.decode.plausibility import metres_between
from guidance_app.decode.sentence import Sentence
from guidance_app.model import FixQuality
from guidance_app.model.making import made_quickly

__all__ = ["POSITION_KINDS", "SECOND_GGA", "Epoch", "Orientation", "orientation_of"]

POSITION_KINDS = ("GGA", "GNS", "KSXT", "PAOGI", "PANDA", "RMC", "GLL")
"""Kinds with a position, best first."""

STRONG_KINDS = POSITION_KINDS[:5]
SECOND_GGA = "GGA of the second antenna"
_NOT_ATTITUDE = frozenset((*POSITION_KINDS, SECOND_GGA, "GST", "VTG", "GSA"))
LONGEST_BASELINE = 20.0
"""Two antennas of one machine are nearer than this, in metres."""


@dataclass(slots=True)
class Epoch:
    """What has come of one epoch so far. ``time`` is the second of the day, ``t`` the continuous time.

    ``arrival`` is when its first sentence came, ``heard`` its last. ``expected`` are the kinds it should hold.
    Once ``closed`` it only waits for the sentences that come too late. Kinds in ``lent`` came before the epoch and
    have been told already.
    """

    time: float | None
    t: float | None
    arrival: float
    heard: float
    expected: frozenset[str]
    closed: bool = False
    sentences: dict[str, Sentence] = field(default_factory=dict)
    lent: set[str] = field(default_factory=set)

    def fork(self) -> "Epoch":
        """An independent copy."""
        return replace(self, sentences=self.sentences.copy(), lent=self.lent.copy())

    def is_complete(self) -> bool:
        """Whether everything has come that usually comes, and with it something about the position."""
        return (
            bool(self.expected)
            and self.expected <= self.sentences.keys()
            and any(kind in self.sentences for kind in POSITION_KINDS)
        )

    def says_no_fix(self) -> bool:
        """Whether the receiver has said that it has no position."""
        said = placed = False
        for kind in POSITION_KINDS:
            sentence = self.sentences.get(kind)
            if sentence is None:
                continue
            if sentence.valid is False and kind in STRONG_KINDS:
                return True
            said, placed = True, placed or sentence.has_position
        return said and not placed

    def position(self) -> Sentence | None:
        """The sentence whose position counts."""
        for kind in POSITION_KINDS:
            sentence = self.sentences.get(kind)
            if sentence is not None and sentence.has_position:
                return sentence
        return None

    def attitudes(self) -> list[Sentence]:
        """The readings of attitude that belong to this epoch alone."""
        return [
            sentence for kind, sentence in self.sentences.items() if kind not in self.lent and kind not in _NOT_ATTITUDE
        ]

    def quality_of(self, position: Sentence) -> FixQuality | None:
        """The fix's quality; None when nobody vouches for it."""
        if position.quality is not None and position.valid:
            return position.quality
        for kind in ("RMC", "GLL"):
            voucher = self.sentences.get(kind)
            if voucher is not None and voucher.valid:
                return voucher.quality or FixQuality.AUTONOMOUS
        return None

    def motion(self, position: Sentence) -> tuple[float | None, float | None]:
        """Speed and course: of RMC, which has a time; else of VTG; else of the sentence with the position."""
        spoken = [self.sentences.get("RMC"), self.sentences.get("VTG"), position]
        speed = next((s.speed for s in spoken if s is not None and s.speed is not None), None)
        course = next((s.course for s in spoken if s is not None and s.course is not None), None)
        return speed, course

    def hdop(self, position: Sentence) -> float | None:
        """HDOP of the position's own sentence, or else of GSA."""
        satellites = self.sentences.get("GSA")
        return satellites.hdop if position.hdop is None and satellites is not None else position.hdop

    def second_antenna_deg(self, position: Sentence) -> tuple[float, float] | None:
        """Where the second GGA of the epoch is; None when it repeats the first or is too far from it."""
        second = self.sentences.get(SECOND_GGA)
        if second is None or not second.valid or second.latitude_deg is None or second.longitude_deg is None:
            return None
        if position.latitude_deg is None or position.longitude_deg is None:
            return None
        place = (second.latitude_deg, second.longitude_deg)
        baseline = metres_between((position.latitude_deg, position.longitude_deg), place)
        return place if 0.0 < baseline < LONGEST_BASELINE else None


@made_quickly
@dataclass(frozen=True, slots=True)
class Orientation:
    """What attitude sentences say together, the first word counting. Radians and radians a second."""

    heading: float | None = None
    roll: float | None = None
    pitch: float | None = None
    roll_rate: float | None = None
    pitch_rate: float | None = None
    yaw_rate: float | None = None

    def says_something(self) -> bool:
        """Whether anything at all is known."""
        return any(
            value is not None
            for value in (self.heading, self.roll, self.pitch, self.roll_rate, self.pitch_rate, self.yaw_rate)
        )


def orientation_of(sentences: Iterable[Sentence], declination: float | None) -> Orientation:
    """The orientation that these sentences give. A magnetic heading counts only with a known ``declination``."""
    heading = magnetic = roll = pitch = roll_rate = pitch_rate = yaw_rate = None
    for said in sentences:
        heading = said.heading if heading is None else heading
        magnetic = said.magnetic_heading if magnetic is None else magnetic
        roll = said.roll if roll is None else roll
        pitch = said.pitch if pitch is None else pitch
        roll_rate = said.roll_rate if roll_rate is None else roll_rate
        pitch_rate = said.pitch_rate if pitch_rate is None else pitch_rate
        yaw_rate = said.yaw_rate if yaw_rate is None else yaw_rate
    if heading is None and magnetic is not None and declination is not None:
        heading = wrap_2pi(math.fmod(magnetic + declination, math.tau))
    return Orientation(heading, roll, pitch, roll_rate, pitch_rate, yaw_rate)
