"""A long day's work as a receiver would tell it: the passes of a plan at constant speed, as NMEA bytes."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
import shapely

from guidance_app.documents import FieldDocument, Geometry, Implement, Job, Operation, Receiver, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.planning import plan_operation
from guidance_app.guidance.wishes import request_from_documents
from guidance_app.model import Chunk, FixQuality, FloatArray
from guidance_app.simulation.receiver import Antenna, ReceiverSettings, SimulatedReceiver

__all__ = ["Day", "day_of_work", "first_chunks"]

ORIGIN_DEG = (52.0, 11.0)
SPEED = 3.0
START = datetime(2026, 5, 4, 6, 0, tzinfo=UTC)


@dataclass(frozen=True, slots=True)
class Day:
    """A job and the bytes of working it."""

    job: Job
    hours: float
    rate: int
    path: FloatArray

    def chunks(self, seed: int = 1) -> Iterator[Chunk]:
        """One chunk an epoch, for as long as the day is; the path is driven again when it ends."""
        receiver = SimulatedReceiver(
            FieldFrame(*ORIGIN_DEG),
            ReceiverSettings(rate=self.rate, decimals=4, quality=FixQuality.DGPS),
            START,
            np.random.default_rng(seed),
        )
        steps = np.hypot(*np.diff(self.path, axis=0).T)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        count = int(self.hours * 3600 * self.rate)
        driven = (np.arange(count) * (SPEED / self.rate)) % along[-1]
        east, north = np.interp(driven, along, self.path[:, 0]), np.interp(driven, along, self.path[:, 1])
        stretch = np.clip(np.searchsorted(along, driven, side="right") - 1, 0, len(steps) - 1)
        towards = np.diff(self.path, axis=0)[stretch] / steps[stretch, np.newaxis]
        for number in range(count):
            heading = math.atan2(towards[number, 0], towards[number, 1])
            antenna = Antenna(
                float(east[number]),
                float(north[number]),
                SPEED * float(towards[number, 0]),
                SPEED * float(towards[number, 1]),
                heading,
                0.0,
            )
            yield Chunk(number / self.rate, receiver.epoch(number, antenna))


def day_of_work(hours: float = 8.0, rate: int = 10, width: float = 12.0, side: float = 1100.0) -> Day:
    """A square field of ``side`` metres, worked in round trips of ``width`` metres for so many hours at ``rate`` Hz."""
    frame = FieldFrame(*ORIGIN_DEG)
    corners = np.array([[0.0, 0.0], [side, 0.0], [side, side], [0.0, side], [0.0, 0.0]]) - side / 2
    ring = [(float(longitude), float(latitude)) for longitude, latitude in frame.lonlat_from_array(corners)]
    ring[-1] = ring[0]
    tractor = Tractor(name="Tractor", turning_radius=6.0)
    implement = Implement(name="Implement", working_width=width, offset_back=2.0)
    field = FieldDocument(name="Large field", boundary=Geometry(coordinates=[ring]))
    operation = Operation(name="Round trip", field=field.name, tractor=tractor.name, implement=implement.name)
    job = Job(
        tractor=tractor, implement=implement, receiver=Receiver(name="Receiver"), field=field, operation=operation
    )
    plan = plan_operation(shapely.Polygon(corners), request_from_documents(tractor, implement, operation))
    path = np.vstack([segment.points for segment in plan.segments])
    moved = np.concatenate([[True], np.hypot(*np.diff(path, axis=0).T) > 1e-6])
    return Day(job, hours, rate, path[moved])


def first_chunks(day: Day, seconds: float) -> list[Chunk]:
    """The first so many seconds of a day, all at once."""
    wanted = int(seconds * day.rate)
    return [chunk for chunk, _ in zip(day.chunks(), range(wanted), strict=False)]
