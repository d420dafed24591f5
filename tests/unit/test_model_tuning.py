"""The search for the adaptive filter's motion models."""

import math

import numpy as np
import pytest

from guidance_app.estimation.filter import FilterSettings
from guidance_app.evaluation.model_tuning import (
    HIGHEST,
    KINDS,
    LOWEST,
    ModelObjective,
    model_search,
    model_settings,
    numbers_of,
)


@pytest.mark.parametrize("kind", list(KINDS))
def test_models_become_numbers_and_numbers_models(kind: str) -> None:
    numbers = np.sqrt(LOWEST * HIGHEST)
    settings = model_settings(kind, numbers)
    assert numbers_of(getattr(settings.adaptive, kind)) == pytest.approx(numbers, rel=1e-3)
    others = [other for other in KINDS if other != kind]
    for other in others:
        assert getattr(settings.adaptive, other) == getattr(FilterSettings().adaptive, other)
    assert FilterSettings.model_validate_json(settings.model_dump_json()) == settings


@pytest.mark.parametrize("kind", ["position", "doppler_gyro"])
def test_the_present_models_beat_sloppy_ones(kind: str) -> None:
    objective = ModelObjective(kind, seeds=1)
    present = objective.value(FilterSettings())
    sloppy = numbers_of(getattr(FilterSettings().adaptive, kind)).copy()
    sloppy[:12] = (1.0, 0.5, 5.0) * 4
    assert math.isfinite(present)
    assert present < objective.value(model_settings(kind, sloppy)) - 0.1


def test_a_search_starts_at_the_present_models_and_never_gets_worse() -> None:
    found = list(model_search(ModelObjective("doppler", seeds=1), evaluations=12))
    values = [one.rms for one in found]
    assert values == sorted(values, reverse=True)
    assert np.all(found[-1].noise >= LOWEST)
    assert np.all(found[-1].noise <= HIGHEST)
