"""How a tractor moves: the equivalent two-wheel model of Inoue et al., equations 15 to 21 and 25 to 27.

Two of the printed equations are read as corrected: the ``v`` squared that is missing in equation 18 is put back, as
solving equations 15 and 16 for the steady state demands, and the steering angle of equation 27 reaches 10 degrees
0.7 s after the idling time of 0.2 s, not 0.7 s after the command. As in the paper slip and yaw rate are the steady
state's of each instant. Speed is signed, backwards is negative; steering, slip and yaw rate are positive clockwise.
"""

import math
from dataclasses import dataclass, replace

from guidance_app.angles import wrap_2pi

__all__ = ["TractorModel", "VehicleState", "model_for", "moved", "rear_axle", "slip_and_yaw_rate", "standing_at"]

REST = math.radians(0.3)
"""A smaller difference between the wanted and the present steering angle does not set the valve going."""

MASS_SHARE_REAR = 0.59
"""Of the wheelbase, the distance from the centre of gravity to the front axle: a tractor rests on its rear wheels."""


@dataclass(frozen=True, slots=True)
class TractorModel:
    """The numbers of one tractor; the defaults are of the size of the paper's 66 kW one.

    ``to_front`` and ``to_rear`` are metres from the centre of gravity to the axles, ``front_stiffness`` and
    ``rear_stiffness`` the cornering stiffness of one wheel in N/rad, ``idle`` the valve's idling time in seconds,
    ``steering_rate`` in rad/s (equation 27: 14.3 degrees a second).
    """

    mass: float = 4000.0
    to_front: float = 1.45
    to_rear: float = 1.0
    front_stiffness: float = 60e3
    rear_stiffness: float = 110e3
    idle: float = 0.2
    steering_rate: float = math.radians(14.3)
    steering_limit: float = math.radians(35)
    acceleration: float = 0.7

    @property
    def wheelbase(self) -> float:
        """Rear axle to front axle."""
        return self.to_front + self.to_rear


@dataclass(frozen=True, slots=True)
class VehicleState:
    """Where the centre of gravity is and how the tractor moves.

    ``turning`` is the way in which the steering moves now (-1, 0 or 1), ``idling`` for how long the valve has idled.
    """

    t: float
    east: float
    north: float
    heading: float
    speed: float = 0.0
    steering: float = 0.0
    slip: float = 0.0
    yaw_rate: float = 0.0
    turning: int = 0
    idling: float = 0.0


def model_for(wheelbase: float) -> TractorModel:
    """A tractor of this wheelbase whose weight lies as a tractor's does."""
    return TractorModel(to_front=MASS_SHARE_REAR * wheelbase, to_rear=(1 - MASS_SHARE_REAR) * wheelbase)


def standing_at(model: TractorModel, east: float, north: float, heading: float) -> VehicleState:
    """At rest with the centre of the rear axle at this place."""
    return VehicleState(
        t=0.0,
        east=east + model.to_rear * math.sin(heading),
        north=north + model.to_rear * math.cos(heading),
        heading=wrap_2pi(heading),
    )


def rear_axle(model: TractorModel, state: VehicleState) -> tuple[float, float]:
    """East and north of the centre of the rear axle, the reference point."""
    return (
        state.east - model.to_rear * math.sin(state.heading),
        state.north - model.to_rear * math.cos(state.heading),
    )


def slip_and_yaw_rate(model: TractorModel, speed: float, steering: float) -> tuple[float, float]:
    """Slip angle of the centre of gravity and yaw rate, equations 17 and 18 with ``v`` squared put back."""
    length, front, rear = model.wheelbase, model.to_front, model.to_rear
    balance = front * model.front_stiffness - rear * model.rear_stiffness
    stability = 1 - model.mass * balance * speed**2 / (2 * length**2 * model.front_stiffness * model.rear_stiffness)
    share = 1 - model.mass * front * speed**2 / (2 * length * rear * model.rear_stiffness)
    return share * rear / length * steering / stability, speed / length * steering / stability


def moved(
    model: TractorModel,
    state: VehicleState,
    wanted: tuple[float, float],
    dt: float,
    disturbance: tuple[float, float] = (0.0, 0.0),
) -> VehicleState:
    """The state after ``dt`` seconds with the ``wanted`` steering angle and speed.

    ``disturbance`` changes slip and yaw rate by these parts of themselves (the paper's noise has 0.08).
    """
    steered = _steered(model, state, max(-model.steering_limit, min(model.steering_limit, wanted[0])), dt)
    change = model.acceleration * dt
    speed = state.speed + max(-change, min(change, wanted[1] - state.speed))
    slip, yaw_rate = slip_and_yaw_rate(model, speed, steered.steering)
    slip *= 1 + disturbance[0]
    yaw_rate *= 1 + disturbance[1]
    course = state.heading + slip + yaw_rate * dt / 2
    return replace(
        steered,
        t=state.t + dt,
        east=state.east + speed * dt * math.sin(course),
        north=state.north + speed * dt * math.cos(course),
        heading=wrap_2pi(state.heading + yaw_rate * dt),
        speed=speed,
        slip=slip,
        yaw_rate=yaw_rate,
    )


def _steered(model: TractorModel, state: VehicleState, wanted: float, dt: float) -> VehicleState:
    """Equations 25 and 26: the valve idles when it starts or turns round, then the angle changes at one rate."""
    gap = wanted - state.steering
    way = (gap > 0) - (gap < 0)
    if way == 0 or (way != state.turning and abs(gap) < REST):
        return replace(state, turning=0, idling=0.0)
    if way != state.turning:
        idling = state.idling + dt
        if idling < model.idle:
            return replace(state, turning=0, idling=idling)
    delay = abs(gap) / model.steering_rate
    steering = wanted if dt >= delay else state.steering + gap * dt / delay
    return replace(state, steering=steering, turning=way, idling=0.0)
