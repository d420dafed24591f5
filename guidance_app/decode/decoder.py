"""Bytes in, observations out: joins the sentences of one epoch into a fix and doubts what cannot be.

An epoch is what shares one UTC time. It closes when the next time appears, when everything has come that the epochs
before held (``habits``), or when 0.3 of the epoch interval has passed in silence, which an empty chunk can tell.

Sentences without a checksum are read only in a stream that has never carried one (they are counted as
``unchecked``); from the first right checksum on, a sentence that lacks it is rejected.

A reading of attitude that comes within an open epoch, once, is part of its fix, or an ``Attitude`` when the epoch
gives none. Every other one is an ``Attitude`` at once: between epochs, of a sensor with a rate of its own, or with a
time that is not the epoch's. One that came less than 0.3 of an interval before an epoch opened, or bears the epoch's
time, is also lent to its fix.

``Fix.arrival`` is when the first sentence of its epoch came, however the epoch was closed, so the same bytes with the
same times always give the same observations.
"""

from collections import Counter
from dataclasses import replace

from guidance_app.decode.clock import DayClock
from guidance_app.decode.epoch import POSITION_KINDS, SECOND_GGA, Epoch, orientation_of
from guidance_app.decode.framing import Framer
from guidance_app.decode.habits import Habits
from guidance_app.decode.nmea import has_checksum, read_line
from guidance_app.decode.plausibility import Place, Plausibility
from guidance_app.decode.sentence import DecodeError, Sentence
from guidance_app.decode.sky import Sky
from guidance_app.decode.usual import Usual
from guidance_app.language import message
from guidance_app.model import Attitude, Chunk, Fix, FixQuality, NoFix, Observation, Rejected, Satellite

__all__ = ["Decoder"]

QUIET = 0.3
"""Part of the epoch interval after which silence closes an epoch."""

FIRST_INTERVAL = 1.0
LONGEST_INTERVAL = 10.0
INTERVALS_KEPT = 5

TIMED_KINDS = frozenset(POSITION_KINDS) | {"GST"}
"""Kinds whose time makes an epoch. ZDA is not among them: some receivers send the time of sending in it."""

ADDED_KINDS = frozenset(("VTG", "GSA"))
"""Kinds without a time that add to a fix."""

NOT_AWAITED = frozenset(("GSA", "GLL"))
"""Kinds for which a fix need not wait: GSA only fills a missing HDOP, GLL repeats what better sentences say."""


class Decoder:
    """Decodes one link. Holds the unfinished line, the open epoch and what the stream has taught; never raises."""

    def __init__(self, link: str = "receiver") -> None:
        self.link = link
        self.sentences = 0
        """Sentences seen, right or wrong."""
        self.unchecked = 0
        """Sentences read that carried no checksum."""
        self._rejected: Counter[str] = Counter()
        self._kinds: Counter[str] = Counter()
        self._framer = Framer()
        self._clock = DayClock()
        self._habits = Habits()
        self._plausibility = Plausibility()
        self._usual = Usual()
        self._sky = Sky()
        self._epoch: Epoch | None = None
        self._closed_time: float | None = None
        self._early: dict[str, tuple[Sentence, float]] = {}
        self._intervals: tuple[float, ...] = ()
        self.interval = FIRST_INTERVAL
        """The epoch interval in seconds, the median of the last ones; 1 until it is known."""
        self._last_fix_t: float | None = None
        self._declination: float | None = None
        self._has_checksums = False
        self._heading_valid = True
        self._attitude_valid = True

    @property
    def rejected(self) -> Counter[str]:
        """How many lines and epochs were not believed, by reason."""
        return self._rejected

    @property
    def kinds(self) -> Counter[str]:
        """How many sentences of each kind were decoded."""
        return self._kinds

    @property
    def sky(self) -> tuple[Satellite, ...]:
        """The satellites in view, as the last whole round of GSV sentences of each system told them."""
        return self._sky.satellites

    @property
    def wake_at(self) -> float | None:
        """Session time at which the open epoch closes without more bytes; None when nothing is open."""
        epoch = self._epoch
        return None if epoch is None or epoch.closed else epoch.heard + QUIET * self.interval

    def fork(self) -> "Decoder":
        """An independent copy that goes on from here; what is shared never changes."""
        copy = Decoder(self.link)
        copy.__dict__.update(self.__dict__)
        copy._rejected, copy._kinds = self._rejected.copy(), self._kinds.copy()
        copy._framer, copy._clock, copy._habits = self._framer.fork(), self._clock.fork(), self._habits.fork()
        copy._plausibility, copy._usual = self._plausibility.fork(), self._usual.fork()
        copy._sky = self._sky.fork()
        copy._epoch = None if self._epoch is None else self._epoch.fork()
        copy._early = self._early.copy()
        return copy

    def feed(self, chunk: Chunk) -> tuple[Observation, ...]:
        """Everything that closed, in order; an empty chunk only tells time."""
        out: list[Observation] = []
        wake_at = self.wake_at
        if wake_at is not None and chunk.arrival >= wake_at:
            self._close(out)
        if chunk.data:
            for line in self._framer.feed(chunk.data):
                self._take_line(line, chunk.arrival, out)
        return tuple(out)

    def finish(self, arrival: float) -> tuple[Observation, ...]:
        """The end of the stream: reads a last line without an end and closes the open epoch."""
        out: list[Observation] = []
        for line in self._framer.finish():
            self._take_line(line, arrival, out)
        self._close(out)
        self._epoch = None
        return tuple(out)

    # --- one sentence ---

    def _take_line(self, line: str, arrival: float, out: list[Observation]) -> None:
        self.sentences += 1
        checked = has_checksum(line)
        if self._has_checksums and not checked:
            self._reject(arrival, line, "checksum missing", out)
            return
        try:
            sentence = read_line(line)
        except DecodeError as error:
            self._reject(arrival, line, str(error), out)
            return
        if checked:
            self._has_checksums = True
        else:
            self.unchecked += 1
        self._kinds[sentence.kind] += 1
        self._take(sentence, arrival, out)

    def _take(self, sentence: Sentence, arrival: float, out: list[Observation]) -> None:
        if sentence.declination is not None:
            self._declination = sentence.declination
        match sentence.kind:
            case kind if kind in TIMED_KINDS:
                self._take_timed(sentence, arrival, out)
            case kind if kind in ADDED_KINDS:
                self._take_added(sentence, arrival, out)
            case "ZDA":
                self._hear(arrival)
                self._learn_date(sentence)
            case "PSXN,20":
                self._hear(arrival)
                self._heading_valid = sentence.heading_valid is not False
                self._attitude_valid = sentence.attitude_valid is not False
            case "GSV":
                self._hear(arrival)
                if sentence.in_view is not None:
                    self._sky.take(sentence.in_view, arrival)
            case _:
                self._take_attitude(sentence, arrival, out)

    def _take_timed(self, sentence: Sentence, arrival: float, out: list[Observation]) -> None:
        """A sentence with the time of its epoch, or one without a time that must then belong to the open one."""
        self._learn_date(sentence)
        epoch = self._epoch
        if sentence.time is None and epoch is not None and sentence.kind not in epoch.sentences:
            self._add(epoch, sentence.kind, sentence, arrival, out)
        elif epoch is not None and sentence.time is not None and sentence.time == epoch.time:
            self._add(epoch, self._place_of(epoch, sentence), sentence, arrival, out)
        elif sentence.time is None or sentence.time != self._closed_time:
            self._close(out)
            epoch = self._open(sentence.time, arrival)
            self._add(epoch, sentence.kind, sentence, arrival, out)

    def _place_of(self, epoch: Epoch, sentence: Sentence) -> str:
        return SECOND_GGA if sentence.kind == "GGA" and "GGA" in epoch.sentences else sentence.kind

    def _take_added(self, sentence: Sentence, arrival: float, out: list[Observation]) -> None:
        epoch = self._listening(arrival)
        if epoch is None:
            self._early[sentence.kind] = (sentence, arrival)
        else:
            self._add(epoch, sentence.kind, sentence, arrival, out)

    def _take_attitude(self, sentence: Sentence, arrival: float, out: list[Observation]) -> None:
        said = self._without_invalid(sentence)
        in_step = self._habits.reads_attitude(said.kind)
        epoch = self._listening(arrival)
        belongs = epoch is not None and said.time in (None, epoch.time) and in_step
        if belongs and epoch is not None:
            was_closed = epoch.closed
            self._add(epoch, said.kind, said, arrival, out)
            if not was_closed:
                return
        elif in_step:
            self._early[said.kind] = (said, arrival)
        self._tell_attitude(said, arrival, out)

    def _without_invalid(self, sentence: Sentence) -> Sentence:
        """A Seapath's reading without what it has called invalid."""
        if not sentence.kind.startswith("PSXN"):
            return sentence
        if not self._heading_valid:
            sentence = replace(sentence, heading=None, yaw_rate=None)
        if not self._attitude_valid:
            sentence = replace(sentence, roll=None, pitch=None, roll_rate=None, pitch_rate=None)
        return sentence

    def _tell_attitude(self, said: Sentence, arrival: float, out: list[Observation]) -> None:
        whole = orientation_of((said,), self._declination)
        if not whole.says_something():
            return
        t = None if said.time is None else self._clock.stamp(said.time)
        out.append(
            Attitude(
                arrival=arrival,
                t=t,
                heading=whole.heading,
                roll=whole.roll,
                pitch=whole.pitch,
                roll_rate=whole.roll_rate,
                pitch_rate=whole.pitch_rate,
                yaw_rate=whole.yaw_rate,
                link=self.link,
            )
        )

    def _learn_date(self, sentence: Sentence) -> None:
        """The date of a sentence that is valid: before its first fix a receiver may say any date."""
        if sentence.date is not None and sentence.time is not None and sentence.valid is not False:
            self._clock.tell_date(sentence.date, sentence.time)

    # --- one epoch ---

    def _listening(self, arrival: float) -> Epoch | None:
        """The epoch that a sentence without a time belongs to: the last one, until silence has parted it off."""
        epoch = self._epoch
        if epoch is None or arrival >= epoch.heard + QUIET * self.interval:
            return None
        return epoch

    def _hear(self, arrival: float) -> None:
        """A sentence that adds nothing to a fix is no silence either: slow lines carry many before the next RMC."""
        epoch = self._listening(arrival)
        if epoch is not None:
            epoch.heard = max(epoch.heard, arrival)

    def _open(self, time: float | None, arrival: float) -> Epoch:
        expected = self._habits.begin_epoch()
        t = None if time is None else self._clock.stamp(time)
        epoch = Epoch(time, t, arrival, arrival, expected)
        for kind, (sentence, came) in self._early.items():
            recent = arrival - came < QUIET * self.interval
            if sentence.time == time if sentence.time is not None else recent:
                epoch.sentences[kind] = sentence
                epoch.lent.add(kind)
        self._early.clear()
        self._epoch = epoch
        return epoch

    def _add(self, epoch: Epoch, kind: str, sentence: Sentence, arrival: float, out: list[Observation]) -> None:
        """Joins a sentence to its epoch; one that comes too late only teaches that it is worth waiting for."""
        if kind not in NOT_AWAITED or (kind == "GLL" and not self._has_better(epoch)):
            self._habits.saw(kind)
        epoch.heard = arrival
        if epoch.closed:
            return
        epoch.sentences.setdefault(kind, sentence)
        if epoch.is_complete():
            self._close(out)

    def _has_better(self, epoch: Epoch) -> bool:
        return any(kind in epoch.sentences for kind in POSITION_KINDS if kind != "GLL")

    def _close(self, out: list[Observation]) -> None:
        """Says what the open epoch held."""
        epoch = self._epoch
        if epoch is None or epoch.closed:
            return
        epoch.closed = True
        self._closed_time = epoch.time
        position = epoch.position()
        if epoch.says_no_fix():
            out.append(NoFix(epoch.arrival, epoch.t, message("no fix")))
            if epoch.t is not None:
                self._clock.believe(epoch.t)
        elif position is not None and self._close_with(epoch, position, out):
            return
        for sentence in epoch.attitudes():
            self._tell_attitude(sentence, epoch.heard, out)

    def _close_with(self, epoch: Epoch, position: Sentence, out: list[Observation]) -> bool:
        """Says the fix of an epoch that has a position, or why there is none."""
        quality = epoch.quality_of(position)
        usual = self._usual.accepts(position)
        if epoch.t is None:
            self._reject(epoch.arrival, "", "position without time", out)
        elif quality is None:
            self._reject(epoch.arrival, "", "fix quality missing", out)
        elif not usual:
            self._reject(epoch.arrival, "", "finer position missing", out)
        else:
            return self._judge(self._fix_of(epoch, epoch.t, position, quality), out)
        return False

    def _fix_of(self, epoch: Epoch, t: float, position: Sentence, quality: FixQuality) -> Fix:
        assert position.latitude_deg is not None
        assert position.longitude_deg is not None
        speed, course = epoch.motion(position)
        accuracy = epoch.sentences.get("GST")
        whole = orientation_of(epoch.sentences.values(), self._declination)
        return Fix(
            t=t,
            arrival=epoch.arrival,
            latitude_deg=position.latitude_deg,
            longitude_deg=position.longitude_deg,
            quality=quality,
            utc=self._clock.utc(t),
            cell=position.cell,
            altitude=position.altitude,
            geoid_separation=position.geoid_separation,
            satellites=position.satellites,
            hdop=epoch.hdop(position),
            sigma=None if accuracy is None else accuracy.sigma,
            speed=speed,
            course=course,
            heading=whole.heading,
            roll=whole.roll,
            pitch=whole.pitch,
            yaw_rate=whole.yaw_rate,
            correction_age=position.correction_age,
            second_antenna_deg=epoch.second_antenna_deg(position),
        )

    def _judge(self, fix: Fix, out: list[Observation]) -> bool:
        """Lets a fix out when it is plausible, without its motion when only that is not; whether it did."""
        if fix.speed is not None and not self._plausibility.believes_speed(fix.t, fix.speed):
            self._reject(fix.arrival, "", "implausible speed", out)
            fix = replace(fix, speed=None, course=None)
        reason = self._plausibility.doubt(Place(fix.t, fix.latitude_deg, fix.longitude_deg, fix.speed))
        if reason is not None:
            self._reject(fix.arrival, "", reason, out)
            return False
        if self._last_fix_t is not None and 0.0 < fix.t - self._last_fix_t <= LONGEST_INTERVAL:
            self._intervals = (*self._intervals[1 - INTERVALS_KEPT :], fix.t - self._last_fix_t)
            self.interval = sorted(self._intervals)[len(self._intervals) // 2]
        self._last_fix_t = fix.t
        self._clock.believe(fix.t)
        out.append(fix)
        return True

    def _reject(self, arrival: float, line: str, reason: str, out: list[Observation]) -> None:
        self._hear(arrival)
        self._rejected[reason] += 1
        out.append(Rejected(arrival, line, reason))
