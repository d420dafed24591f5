"""How a tractor is driven: the adaptive filter's motion models, and the numbers they were tuned to.

Four ways of driving are enough and not too many: on a **straight** line at a steady speed, on one at an **uneven**
speed, in **gentle** corrections and bends, in a **turn**. With one model smoothness is paid for with lag; with three a
speed that changes a little on a bend passes for a turn (5.2 cm and 2.6 degrees instead of 3.7 and 0.4).

The numbers were found by CMA-ES on all eight scenarios at once, at 5 and at 1 Hz, with a wandering speed and the
eighteen lines of Gomez-Gil et al. beside them, and with a price on an ellipse that does not hold (``guidance-app tune
--models``). A tuning on straight lines alone is 1.3 to 2.2 m off on arcs.
"""

from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from guidance_app.documents import quantity

__all__ = ["DOPPLER", "DOPPLER_GYRO", "GYRO", "POSITION", "ModelSet", "MotionModel", "SettingsPart"]


class SettingsPart(BaseModel):
    """A part of the settings: frozen, and a misspelt member is refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


class MotionModel(SettingsPart):
    """How a tractor may move: white acceleration, and a curvature that is forgotten exponentially."""

    acceleration: float = quantity("Acceleration noise", "m/s per square root of s", 1e-5, 5, 0.15, step=0.001)
    curvature: float = quantity("Curvature", "1/m", 1e-6, 2, 0.1, step=0.001)
    memory: float = quantity("Memory of the curvature", "s", 0.02, 600, 3.0, step=0.1)


Rate = Annotated[float, Field(gt=0, le=50, allow_inf_nan=False, json_schema_extra={"unit": "1/s"})]


class ModelSet(SettingsPart):
    """Four ways of driving and how often the driver changes between them, as rates per second."""

    straight: MotionModel
    uneven: MotionModel
    gentle: MotionModel
    turn: MotionModel
    straight_to_uneven: Rate
    uneven_to_gentle: Rate
    uneven_to_straight: Rate
    gentle_to_uneven: Rate
    any_to_turn: Rate
    turn_to_any: Rate

    @property
    def models(self) -> tuple[MotionModel, ...]:
        """From the calmest to the most mobile."""
        return self.straight, self.uneven, self.gentle, self.turn

    @property
    def rates(self) -> tuple[float, ...]:
        """In the order of the fields."""
        return (
            self.straight_to_uneven,
            self.uneven_to_gentle,
            self.uneven_to_straight,
            self.gentle_to_uneven,
            self.any_to_turn,
            self.turn_to_any,
        )

    @property
    def numbers(self) -> tuple[float, ...]:
        """All eighteen: acceleration, curvature and memory of each model, then the rates."""
        return (*(n for m in self.models for n in (m.acceleration, m.curvature, m.memory)), *self.rates)

    @classmethod
    def of(cls, numbers: Sequence[float]) -> "ModelSet":
        """From eighteen numbers in the order of ``numbers``."""
        assert len(numbers) == 18, "four models of three numbers and six rates"
        straight, uneven, gentle, turn = (
            MotionModel(acceleration=numbers[k], curvature=numbers[k + 1], memory=numbers[k + 2]) for k in (0, 3, 6, 9)
        )
        return cls(
            straight=straight,
            uneven=uneven,
            gentle=gentle,
            turn=turn,
            straight_to_uneven=numbers[12],
            uneven_to_gentle=numbers[13],
            uneven_to_straight=numbers[14],
            gentle_to_uneven=numbers[15],
            any_to_turn=numbers[16],
            turn_to_any=numbers[17],
        )


# fmt: off
POSITION = ModelSet.of((
    0.0001494, 0.005291, 500, 0.101, 0.001156, 404.7, 0.0003216, 0.01687, 0.8986, 0.3219, 0.09802, 2.542,
    0.001597, 0.004642, 0.004531, 0.001, 0.001, 0.2221,
))
"""Position alone."""
DOPPLER = ModelSet.of((
    0.0001493, 0.0047, 500, 0.07354, 0.001221, 500, 0.0003176, 0.01608, 1.039, 0.2591, 0.09751, 6.076,
    0.001941, 0.002484, 0.001817, 0.001802, 0.001074, 0.1978,
))
"""Position with the receiver's course and speed."""
GYRO = ModelSet.of((
    0.0002958, 0.03822, 56.67, 0.1086, 0.02488, 20.87, 0.00074, 0.0001875, 0.3054, 0.3208, 0.0004452, 4.908,
    0.001529, 0.007372, 0.023, 0.08037, 0.001628, 0.04974,
))
"""Position with a gyro."""
DOPPLER_GYRO = ModelSet.of((
    0.0001021, 0.003192, 500, 0.08489, 0.002224, 495.3, 0.0001377, 0.03185, 61.84, 0.2373, 0.02392, 10.6,
    0.001504, 0.002233, 0.001039, 0.00166, 0.001007, 0.04497,
))
"""Position with course, speed and gyro."""
# fmt: on
