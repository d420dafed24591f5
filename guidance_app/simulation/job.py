"""A whole job: the tractor stands, drives a plan to its end, stands; epoch by epoch with the truth beside the bytes.

The driver follows the position on the screen, so the receiver's slow drift moves the true track; of its noise and
rounding the driver sees nothing, as a good filter takes them away. In a loss of the fix the driver drives on by sight.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

import numpy as np

from guidance_app.documents import Implement, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.model import Pose, Segment, SegmentKind
from guidance_app.simulation.driver import Control, Driver, DriverSettings, Seen
from guidance_app.simulation.receiver import Antenna, ReceiverSettings, SimulatedReceiver
from guidance_app.simulation.route import Stretch, stretches_of
from guidance_app.simulation.vehicle import TractorModel, VehicleState, model_for, moved, rear_axle, standing_at

__all__ = ["START", "JobSettings", "LossOfFix", "SimulatedEpoch", "simulated_epochs"]

STEPS_A_SECOND = 50
"""Of the vehicle model; a multiple of every rate up to 50 Hz that divides it."""
GUST_S = 0.1
"""Seconds for which a disturbance of slip and yaw rate lasts."""
START = datetime(2026, 4, 14, 7, 30, tzinfo=UTC)


@dataclass(frozen=True, slots=True)
class LossOfFix:
    """The fix is lost in the middle of this pass for this many seconds."""

    pass_number: int
    seconds: float


@dataclass(frozen=True, slots=True)
class JobSettings:
    """How a job goes. ``stand_s`` seconds of standing come before and ``end_s`` after the drive.

    The tractor stands ``start_right`` metres right of the first line, and if ``endless`` begins again at the end.
    ``disturbance`` is the part of slip and yaw rate that uneven ground adds or takes (8 % in the paper).
    """

    driver: DriverSettings = field(default_factory=DriverSettings)
    receiver: ReceiverSettings = field(default_factory=ReceiverSettings)
    steering_rate_deg: float = 30.0
    stand_s: float = 12.0
    end_s: float = 5.0
    disturbance: float = 0.08
    start_right: float = 0.0
    loss: LossOfFix | None = None
    start: datetime = START
    endless: bool = False


@dataclass(frozen=True, slots=True)
class SimulatedEpoch:
    """One epoch: ``t`` seconds since the start, the receiver's bytes, and the truth.

    ``truth`` is the reference point's pose in the field frame; ``kind`` and ``number`` name the segment driven.
    """

    t: float
    data: bytes
    truth: Pose
    implement_down: bool
    kind: SegmentKind
    number: int
    has_fix: bool


def simulated_epochs(
    segments: Sequence[Segment],
    machine: tuple[Tractor, Implement],
    frame: FieldFrame,
    settings: JobSettings,
    generator: np.random.Generator,
) -> Iterator[SimulatedEpoch]:
    """Every epoch from standing at the first segment's start to standing at the last one's end.

    Raises ``ValueError`` when there is nothing to drive or the rate does not go into the model's steps.
    """
    stretches = stretches_of(segments)
    if not stretches:
        msg = "there is no segment to drive"
        raise ValueError(msg)
    if STEPS_A_SECOND % settings.receiver.rate:
        msg = f"a rate of {settings.receiver.rate} Hz does not go into {STEPS_A_SECOND} steps a second"
        raise ValueError(msg)
    return _Drive(stretches, machine, frame, settings, generator).epochs()


@dataclass(slots=True)
class _Drive:
    """What the job remembers between its steps."""

    stretches: tuple[Stretch, ...]
    machine: tuple[Tractor, Implement]
    frame: FieldFrame
    settings: JobSettings
    generator: np.random.Generator
    model: TractorModel = field(init=False)
    gust: tuple[float, float] = field(init=False, default=(0.0, 0.0))
    lost_until: float | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        """A tractor of this wheelbase, steered by hand: faster than the paper's valve."""
        steering_rate = math.radians(self.settings.steering_rate_deg)
        self.model = replace(model_for(self.machine[0].wheelbase), steering_rate=steering_rate)

    def epochs(self) -> Iterator[SimulatedEpoch]:
        tractor, implement = self.machine
        settings = self.settings
        receiver = SimulatedReceiver(self.frame, settings.receiver, settings.start, self.generator)
        driver = Driver(
            self.model,
            self.stretches,
            settings.driver,
            implement.offset_back,
            self.generator,
            endless=settings.endless,
        )
        state = self._first_state(implement)
        steps_an_epoch = STEPS_A_SECOND // settings.receiver.rate
        control = driver.look(0.0, self._seen(state, receiver, implement))
        finished_at: float | None = None
        for step in range(10**9):
            t = step / STEPS_A_SECOND
            standing = t < settings.stand_s or finished_at is not None
            if not standing:
                control = driver.look(t, self._seen(state, receiver, implement))
            if step % steps_an_epoch == 0:
                number = step // steps_an_epoch
                yield self._epoch(number, t, state, control, receiver, tractor)
            if control.finished and finished_at is None:
                finished_at = t
            if finished_at is not None and t - finished_at >= settings.end_s:
                return
            state = self._stepped(step, state, (0.0, 0.0) if standing else (control.steering, control.speed))

    def _first_state(self, implement: Implement) -> VehicleState:
        """At rest at the beginning of the first stretch, beside its line."""
        stretch = self.stretches[0]
        first = stretch.points[0]
        heading = stretch.place_of(float(first[0]), float(first[1]), 0.0).heading
        side = self.settings.start_right - implement.offset_right
        east = float(first[0]) + side * math.cos(heading)
        north = float(first[1]) - side * math.sin(heading)
        return standing_at(self.model, east, north, heading + (math.pi if stretch.reverse else 0.0))

    def _stepped(self, step: int, state: VehicleState, wanted: tuple[float, float]) -> VehicleState:
        if step % round(GUST_S * STEPS_A_SECOND) == 0:
            gust = self.settings.disturbance * self.generator.standard_normal(2)
            self.gust = float(gust[0]), float(gust[1])
        return moved(self.model, state, wanted, 1 / STEPS_A_SECOND, self.gust)

    def _seen(self, state: VehicleState, receiver: SimulatedReceiver, implement: Implement) -> Seen:
        """The guided point as the screen shows it: with the receiver's drift."""
        east, north = rear_axle(self.model, state)
        side = implement.offset_right
        return Seen(
            east=east + side * math.cos(state.heading) + receiver.drift[0],
            north=north - side * math.sin(state.heading) + receiver.drift[1],
            heading=state.heading,
            speed=state.speed,
            yaw_rate=state.yaw_rate,
        )

    def _epoch(
        self,
        number: int,
        t: float,
        state: VehicleState,
        control: Control,
        receiver: SimulatedReceiver,
        tractor: Tractor,
    ) -> SimulatedEpoch:
        lost = self._is_lost(t, control)
        data = receiver.no_fix(number) if lost else receiver.epoch(number, _antenna(self.model, state, tractor))
        east, north = rear_axle(self.model, state)
        truth = Pose(
            t=t,
            arrival=t,
            east=east,
            north=north,
            heading=state.heading,
            speed=state.speed,
            curvature=state.yaw_rate / state.speed if state.speed else 0.0,
            standing=state.speed == 0.0,
            reverse=state.speed < 0,
        )
        part = control.part
        return SimulatedEpoch(t, data, truth, control.implement_down, part.kind, part.number, has_fix=not lost)

    def _is_lost(self, t: float, control: Control) -> bool:
        """Whether the fix is away now; it goes once, in the middle of the pass that is named."""
        loss = self.settings.loss
        if loss is None:
            return False
        if self.lost_until is None:
            part = control.part
            named = part.kind is SegmentKind.PASS and part.number == loss.pass_number
            if not named or control.along < part.start + part.length / 2:
                return False
            self.lost_until = t + loss.seconds
        return t < self.lost_until


def _antenna(model: TractorModel, state: VehicleState, tractor: Tractor) -> Antenna:
    """The antenna on level ground: where its lever arm puts it, and how it moves with the body."""
    ahead_east, ahead_north = math.sin(state.heading), math.cos(state.heading)
    east, north = rear_axle(model, state)
    forward, right = tractor.antenna_forward, tractor.antenna_right
    course = state.heading + state.slip
    # From the centre of gravity, whose motion the model gives, to the antenna.
    lever = forward - model.to_rear
    return Antenna(
        east=east + forward * ahead_east + right * ahead_north,
        north=north + forward * ahead_north - right * ahead_east,
        speed_east=state.speed * math.sin(course) + state.yaw_rate * (lever * ahead_north - right * ahead_east),
        speed_north=state.speed * math.cos(course) - state.yaw_rate * (lever * ahead_east + right * ahead_north),
        heading=state.heading,
        yaw_rate=state.yaw_rate,
    )
