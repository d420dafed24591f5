"""The settings document: its bounds, and that it comes back from JSON as it went."""

from typing import Any

import pytest
from pydantic import ValidationError

from guidance_app.estimation.filter import FilterSettings, GyroSettings, QuantisationSettings
from guidance_app.estimation.filters import make_filter

Q = [0.23, 0.26, 0.01, 1.05]


def refused(document: dict[str, Any]) -> str:
    with pytest.raises(ValidationError) as caught:
        FilterSettings.model_validate(document)
    error = caught.value.errors()[0]
    return f"{'.'.join(map(str, error['loc']))}: {error['msg']}, not {error['input']}"


@pytest.mark.parametrize("bad", [0, -1.0, float("inf"), float("nan")])
@pytest.mark.parametrize("matrix", ["process_noise", "measurement_noise", "start_covariance"])
def test_a_variance_that_is_not_positive_is_refused_with_field_value_and_bound(matrix: str, bad: float):
    sentence = refused({"quantisation_kf": {matrix: [*Q[:2], bad, Q[3]]}})
    assert f"quantisation_kf.{matrix}.2" in sentence
    assert str(bad) in sentence
    assert "greater than 0" in sentence or "finite" in sentence or "less than or equal" in sentence


@pytest.mark.parametrize("bad", [0.4, 3.1])
def test_a_look_ahead_out_of_bounds_is_refused_with_field_value_and_bound(bad: float):
    sentence = refused({"look_ahead": bad})
    assert "look_ahead" in sentence
    assert str(bad) in sentence
    assert "0.5" in sentence or "3" in sentence


@pytest.mark.parametrize(
    "document",
    [
        {"gyro_ekf": {"position_noise": 0}},
        {"gyro_ekf": {"heading_walk": -1}},
        {"adaptive": {"velocity_noise": 0}},
        {"adaptive": {"gate": 2}},
        {"adaptive": {"position": {"straight": {"acceleration": -1}}}},
        {"quantisation_kf": {"process_noise": Q[:3]}},
        {"quantisation": {}},
        {"smoother": {"position": {"memory": 0}}},
    ],
)
def test_everything_else_out_of_bounds_is_refused_too(document: dict[str, Any]):
    assert refused(document)


def test_a_document_comes_back_from_json_as_it_went():
    settings = FilterSettings(
        quantisation_kf=QuantisationSettings(process_noise=(1, 2, 3, 4)), gyro_ekf=GyroSettings(as_printed=True)
    )
    assert FilterSettings.model_validate_json(settings.model_dump_json()) == settings


def test_settings_are_frozen_and_reach_the_filter():
    settings = FilterSettings()
    with pytest.raises(ValidationError):
        settings.look_ahead = 1.0  # type: ignore[misc] # the point
    assert make_filter("quantisation_kf", settings) is not make_filter("quantisation_kf", settings)
