"""What the driver has chosen for the screen."""

import itertools
from enum import StrEnum
from typing import Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from guidance_app.documents.base import Document, choice
from guidance_app.language import message

__all__ = ["LightBarSteps", "Settings", "Units"]


class Units(StrEnum):
    """What the screen counts in; inside everything stays metric."""

    METRIC = "metric"
    IMPERIAL = "imperial"
    JAPANESE = "japanese"
    """Metric, areas in ares."""
    TAN = "tan"
    """Metric, areas in tan and chō."""


LightBarSteps = tuple[float, float, float, float, float, float, float, float]


class Settings(Document):
    """What the driver has chosen for the screen."""

    kind: Literal["settings"] = "settings"
    units: Units = choice(
        "Units",
        Units.METRIC,
        {
            Units.METRIC: message("Metric"),
            Units.IMPERIAL: message("Imperial"),
            Units.JAPANESE: message("Metric, areas in ares"),
            Units.TAN: message("Metric, areas in tan and chō"),
        },
    )
    language: Literal["en", "ja", "es"] = choice("Language", "en", {"en": "English", "ja": "日本語", "es": "Español"})
    light_bar_steps: LightBarSteps = Field((0.02, 0.05, 0.10, 0.20, 0.30, 0.50, 0.75, 1.00), title="Light bar steps")
    night: bool = Field(default=False, title="Night")
    sounds: bool = Field(default=True, title="Sounds")
    guide_implement: bool = Field(default=False, title="Guide the implement instead of the tractor")

    @model_validator(mode="after")
    def _steps_grow(self) -> "Settings":
        steps = self.light_bar_steps
        grows = all(low < high for low, high in itertools.pairwise(steps))
        if not grows or steps[0] < 0.005 or steps[-1] > 10:
            raise PydanticCustomError(
                "light_bar_steps",
                message("Each step of the light bar must be larger than the one before, from 0.5 cm to 10 m."),
            )
        return self
