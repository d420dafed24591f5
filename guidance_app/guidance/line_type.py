"""What a guidance line type is to the console: a name, an explanation, and how passes come from its points."""

from collections.abc import Callable
from dataclasses import dataclass

from guidance_app.guidance.family import PassFamily
from guidance_app.model import FloatArray

__all__ = ["LineType"]


@dataclass(frozen=True, slots=True)
class LineType:
    """One way to drive without a plan.

    ``family`` takes points of shape (N, 2), as a field's guidance line stores them, and the swath spacing. It raises
    ``GuidanceLineError`` with a sentence for the driver.
    """

    name: str
    title: str
    explanation: str
    family: Callable[[FloatArray, float], PassFamily]
