"""``sim:``, a receiver on a tractor that drives the sample field over and over, or the field of a job by its plan.

It is a receiver like any other: what comes out are the bytes of its sentences, an epoch a chunk. Options follow a
question mark: ``sim:?rate=10&decimals=7&seed=3&speed=8``. Work without an end, it makes each epoch when it is taken.
"""

import math
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from types import MappingProxyType
from urllib.parse import parse_qsl

import numpy as np
import shapely

from guidance_app.angles import heading_between, yaw_from_heading
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.documents import Direction, Implement, Job, Method, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.planning import PlanError, PlanRequest, plan_operation
from guidance_app.guidance.room import Room
from guidance_app.guidance.turn import Leg
from guidance_app.guidance.turns import Turner
from guidance_app.guidance.wishes import request_of
from guidance_app.language import sentence
from guidance_app.model import Chunk, FloatArray, Segment, SegmentKind, SourceUp
from guidance_app.simulation.driver import DriverSettings
from guidance_app.simulation.job import START, JobSettings, simulated_epochs
from guidance_app.simulation.receiver import SENTENCES, ReceiverSettings
from guidance_app.simulation.sample import sample_job
from guidance_app.sources import SourceError

__all__ = [
    "SampleDrive",
    "SimulatedOptions",
    "SimulatedSource",
    "Way",
    "open_simulated",
    "open_simulated_on",
    "sample_drive",
]

KMH = 1 / 3.6
RATES = (1, 2, 5, 10, 25, 50)
ROOM = 500.0
"""Metres around a plan in which a simulated tractor finds any turn."""


@dataclass(frozen=True, slots=True)
class SimulatedOptions:
    """What may be asked of ``sim:``. ``rate`` in Hz, ``decimals`` of a minute, working ``speed`` in km/h."""

    rate: int = 5
    decimals: int = 4
    seed: int = 1
    speed_kmh: float = 9.0
    sentences: tuple[str, ...] = ("GGA", "RMC", "VTG")

    def job_settings(self, way: "Way") -> JobSettings:
        """The same for the simulation. What has an end is followed by standing until somebody stops it."""
        return JobSettings(
            driver=DriverSettings(work_speed=self.speed_kmh * KMH),
            receiver=ReceiverSettings(rate=self.rate, decimals=self.decimals, sentences=self.sentences),
            stand_s=5.0,
            end_s=math.inf,
            start_right=0.5,
            endless=way.endless,
            start=way.start,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """What is driven, by which tractor with which implement; ``endless`` when its end leads to its beginning.

    ``start`` is what the receiver's clock shows first: a drive that goes on after a power cut must not go back in time.
    """

    frame: FieldFrame
    segments: tuple[Segment, ...]
    machine: tuple[Tractor, Implement]
    endless: bool
    start: datetime = START


@dataclass(frozen=True, slots=True)
class SimulatedSource:
    """An endless receiver. It gives its chunks as fast as they are taken; their times are those of the epochs."""

    options: SimulatedOptions
    way: Way | None = None
    """None: over the sample field."""
    description: str = "simulated receiver on the sample field"
    duration: float | None = None
    live: bool = field(default=False, init=False)

    def events(self, stop: threading.Event) -> Iterator[Chunk | SourceUp]:
        """``SourceUp``, then one chunk an epoch until ``stop`` is set."""
        yield SourceUp(0.0, self.description)
        way = _sample_way() if self.way is None else self.way
        epochs = simulated_epochs(
            way.segments,
            way.machine,
            way.frame,
            self.options.job_settings(way),
            np.random.default_rng(self.options.seed),
        )
        for epoch in epochs:
            if stop.is_set():
                return
            yield Chunk(epoch.t, epoch.data)


def open_simulated(uri: str) -> SimulatedSource:
    """The source of a ``sim:`` URI. Raises ``SourceError`` for an option or a value that is not possible."""
    _, _, rest = uri.partition(":")
    place, _, query = rest.partition("?")
    if place.strip("/"):
        msg = sentence("'{uri}': after sim: come only options, as in sim:?rate=5&decimals=4", uri=uri)
        raise SourceError(msg)
    chosen: dict[str, object] = {}
    for name, text in parse_qsl(query, keep_blank_values=True):
        option = _OPTIONS.get(name)
        if option is None:
            msg = sentence(
                "'{uri}': '{name}' is no option of sim:; there are {names}",
                uri=uri,
                name=name,
                names=", ".join(_OPTIONS),
            )
            raise SourceError(msg)
        if option.member in chosen:
            msg = sentence("'{uri}': '{name}' is given twice", uri=uri, name=name)
            raise SourceError(msg)
        try:
            chosen[option.member] = option.read(text)
        except ValueError as error:
            msg = sentence("'{uri}': {name} is {text!r}, but {rule}", uri=uri, name=name, text=text, rule=option.rule)
            raise SourceError(msg) from error
    return SimulatedSource(SimulatedOptions(**chosen))  # type: ignore[arg-type] # each reader gives its member's type


def open_simulated_on(uri: str, job: Job, number: int | None = None) -> SimulatedSource:
    """The same on the job's own field, by its plan; one that is worked without a plan is driven to and fro.

    The tractor begins with the pass or lap of this ``number``, as after a stop on it; without one with the first.
    Raises ``SourceError`` too where there is no way on the field.
    """
    source = open_simulated(uri)
    if job.field is None:
        return source
    operation = job.operation
    if operation is not None and operation.method is Method.LINE:
        operation = operation.model_copy(update={"method": Method.ROUND_TRIP, "direction": Direction.LONGEST_EDGE})
    frame = frame_of(job.field.boundary)
    try:
        request = request_of(job.model_copy(update={"operation": operation}))
        plan = plan_operation(polygon_in(frame, job.field.boundary), request)
    except PlanError as error:
        msg = sentence("the simulated tractor finds no way on this field: {reason}", reason=str(error))
        raise SourceError(msg) from error
    segments = tuple(_drivable(_from_pass(plan.segments, number), request))
    way = Way(
        frame, segments, (job.tractor, job.implement), endless=False, start=datetime.now(UTC).replace(microsecond=0)
    )
    said = sentence("simulated receiver on the field '{field}'", field=job.field.name)
    return replace(source, way=way, description=said)


def _from_pass(segments: Sequence[Segment], number: int | None) -> Sequence[Segment]:
    """From the pass or lap of this number on; all of them where there is none."""
    works = (place for place, segment in enumerate(segments) if segment.implement_down and segment.number == number)
    return segments[next(works, 0) :]


def _drivable(segments: Sequence[Segment], request: PlanRequest) -> Iterator[Segment]:
    """The plan with a way that a tractor can drive in place of each that does not fit, as if there were room for it."""
    places = np.concatenate([each.points for each in segments])
    roomy = shapely.box(*places.min(axis=0), *places.max(axis=0)).buffer(ROOM)
    turner = Turner(Room(roomy, request.body), request)
    before: Segment | None = None
    lacking = False
    for segment in segments:
        if not segment.fits:
            lacking = True
            continue
        if lacking and before is not None:
            yield from _way_between(before, segment, turner)
        lacking, before = False, segment
        yield segment


def _way_between(before: Segment, after: Segment, turner: Turner) -> Iterator[Segment]:
    ring = np.vstack([before.points, before.points[:1]]) if before.closed else before.points
    start, end = _pose(ring[-2], ring[-1], ring[-1]), _pose(after.points[0], after.points[1], after.points[0])
    turn = turner.turns(start, end)[0]
    legs = () if turn is None else turn.legs
    return (_transfer(leg, after.number) for leg in legs)


def _sample_way() -> Way:
    job = sample_job()
    drive = sample_drive(job)
    return Way(drive.frame, (*drive.passes, *drive.way_back), (job.tractor, job.implement), endless=True)


@dataclass(frozen=True, slots=True, eq=False)
class SampleDrive:
    """The sample field as it is driven: its frame, and the plan's passes with the turns between them.

    ``way_back`` leads from the last pass's end to the first one's start.
    """

    frame: FieldFrame
    passes: tuple[Segment, ...]
    way_back: tuple[Segment, ...]


def sample_drive(job: Job) -> SampleDrive:
    """The drive of the sample's documents, planned from the field's entrance as a session plans it."""
    if job.field is None or job.field.entrance is None:
        msg = sentence("the sample needs a field with an entrance")
        raise SourceError(msg)
    frame = frame_of(job.field.boundary)
    polygon = polygon_in(frame, job.field.boundary)
    request = request_of(job)
    segments = plan_operation(polygon, request).segments
    places = [place for place, segment in enumerate(segments) if segment.kind is SegmentKind.PASS]
    passes = segments[places[0] : places[-1] + 1]
    end, begin = passes[-1].points, passes[0].points
    turner = Turner(Room(polygon, request.body), request)
    turn = turner.turns(_pose(end[-2], end[-1], end[-1]), _pose(begin[0], begin[1], begin[0]))[0]
    if turn is None:
        msg = sentence("the sample field has no room for the way back to its first pass")
        raise SourceError(msg)
    return SampleDrive(frame, passes, tuple(_transfer(leg, passes[0].number) for leg in turn.legs))


def _transfer(leg: Leg, number: int) -> Segment:
    length = float(np.hypot(*np.diff(leg.points, axis=0).T).sum())
    return Segment(SegmentKind.TRANSFER, number, leg.points, implement_down=False, length=length, reverse=leg.reverse)


def _pose(before: FloatArray, after: FloatArray, at: FloatArray) -> FloatArray:
    """Shape (1, 3): east, north and yaw at ``at`` on the way from ``before`` to ``after``."""
    heading = heading_between((float(before[0]), float(before[1])), (float(after[0]), float(after[1])))
    return np.array([[at[0], at[1], yaw_from_heading(heading)]])


# --- options ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Option:
    member: str
    read: Callable[[str], object]
    rule: str


def _rate(text: str) -> int:
    return _within(int(text), RATES)


def _decimals(text: str) -> int:
    return _within(int(text), range(2, 10))


def _seed(text: str) -> int:
    return _within(int(text), range(2**32))


def _within(value: int, possible: tuple[int, ...] | range) -> int:
    if value not in possible:
        raise ValueError(value)
    return value


def _speed(text: str) -> float:
    value = float(text)
    if not 2 <= value <= 15:
        raise ValueError(value)
    return value


def _sentences(text: str) -> tuple[str, ...]:
    names = tuple(dict.fromkeys(text.upper().split(",")))
    if "GGA" not in names or not set(names) <= set(SENTENCES):
        raise ValueError(text)
    return names


_OPTIONS: Mapping[str, _Option] = MappingProxyType(
    {
        "rate": _Option("rate", _rate, f"it is one of {', '.join(map(str, RATES))} Hz"),
        "decimals": _Option("decimals", _decimals, "it is a number of decimals of a minute from 2 to 9"),
        "seed": _Option("seed", _seed, "it is a whole number from 0"),
        "speed": _Option("speed_kmh", _speed, "it is a working speed from 2 to 15 km/h"),
        "sentences": _Option("sentences", _sentences, f"it is GGA and any of {', '.join(SENTENCES[1:])}, with commas"),
    }
)
