"""Short drives as receivers tell them: chunks, one an epoch, of straight work up and down."""

import math
from datetime import UTC, datetime

import numpy as np

from guidance_app.documents import FieldDocument, Geometry, Implement, Job, Operation, Receiver, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Chunk
from guidance_app.simulation.receiver import Antenna, ReceiverSettings, SimulatedReceiver

ORIGIN_DEG = (47.5, 8.5)
FRAME = FieldFrame(*ORIGIN_DEG)
SPEED = 2.5


def a_field(side: float = 120.0) -> FieldDocument:
    """A square field whose lower left corner is the frame's origin."""
    corners = np.array([[0.0, 0.0], [side, 0.0], [side, side], [0.0, side], [0.0, 0.0]])
    ring = [(float(longitude), float(latitude)) for longitude, latitude in FRAME.lonlat_from_array(corners)]
    ring[-1] = ring[0]
    return FieldDocument(name="Square", boundary=Geometry(coordinates=[ring]))


def a_job(*, field: bool = True, filter_name: str = "quantisation_kf", width: float = 6.0) -> Job:
    """A tractor without lever arms, so that the antenna is the reference point."""
    tractor = Tractor(name="Tractor", antenna_height=0.0)
    implement = Implement(name="Implement", working_width=width, offset_back=0.0)
    operation = Operation(name="Work", field="Square", tractor="Tractor", implement="Implement", laps=2)
    return Job(
        tractor=tractor,
        implement=implement,
        receiver=Receiver(name="Receiver", filter=filter_name),
        field=a_field() if field else None,
        operation=operation if field else None,
    )


def path_chunks(points: list[tuple[float, float]], *, rate: int = 5, decimals: int = 7, seed: int = 1) -> list[Chunk]:
    """The bytes of driving through these points (east, north) of the frame at 2.5 m/s."""
    settings = ReceiverSettings(rate=rate, decimals=decimals, noise=0.0, drift=0.0, doppler=0.0)
    receiver = SimulatedReceiver(FRAME, settings, datetime(2026, 4, 1, 8, tzinfo=UTC), np.random.default_rng(seed))
    line = np.array(points)
    steps = np.hypot(*np.diff(line, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    count = int(along[-1] / SPEED * rate)
    chunks = []
    for number in range(count):
        driven = number * SPEED / rate
        stretch = min(int(np.searchsorted(along, driven, side="right")) - 1, len(steps) - 1)
        towards = (line[stretch + 1] - line[stretch]) / steps[stretch]
        east, north = line[stretch] + towards * (driven - along[stretch])
        heading = math.atan2(towards[0], towards[1])
        antenna = Antenna(float(east), float(north), SPEED * towards[0], SPEED * towards[1], heading, 0.0)
        chunks.append(Chunk(number / rate, receiver.epoch(number, antenna)))
    return chunks


def up_and_down(length: float = 90.0, spacing: float = 6.0, passes: int = 3) -> list[tuple[float, float]]:
    """Corners of passes driven north and south, side by side towards the east, 15 m from the field's edge."""
    points = []
    for number in range(passes):
        east = 15.0 + number * spacing
        ends = [(east, 15.0), (east, 15.0 + length)]
        points += ends if number % 2 == 0 else ends[::-1]
    return points
