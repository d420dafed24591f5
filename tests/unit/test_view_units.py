"""Numbers as a driver reads them."""

import pytest

from guidance_app.documents import Units
from guidance_app.language import ENGLISH, words_for
from guidance_app.view.units import area_text, distance_text, offset_text, speed_text, speed_unit


@pytest.mark.parametrize(
    ("metres", "metric", "imperial"),
    [
        (0.0, "0 cm", "0 in"),
        (-0.0049, "0 cm", "0 in"),
        (0.124, "12 cm", "5 in"),
        (-0.124, "12 cm", "5 in"),
        (0.9949, "99 cm", "3.3 ft"),
        (0.9951, "1.00 m", "3.3 ft"),
        (9.99, "9.99 m", "32.8 ft"),
        (9.999, "10.0 m", "32.8 ft"),
        (99.96, "100 m", "328 ft"),
        (1234.5, "1234 m", "4050 ft"),
    ],
)
def test_an_offset_has_few_digits_and_no_sign(metres: float, metric: str, imperial: str) -> None:
    assert offset_text(metres, Units.METRIC, ENGLISH) == metric
    assert offset_text(metres, Units.JAPANESE, ENGLISH) == metric
    assert offset_text(metres, Units.IMPERIAL, ENGLISH) == imperial


@pytest.mark.parametrize(
    ("metres", "metric", "imperial"),
    [(-1.0, "0 m", "0 ft"), (42.4, "42 m", "139 ft"), (999.4, "999 m", "0.6 mi"), (1240.0, "1.2 km", "0.8 mi")],
)
def test_a_distance_changes_its_unit_with_its_size(metres: float, metric: str, imperial: str) -> None:
    assert distance_text(metres, Units.METRIC, ENGLISH) == metric
    assert distance_text(metres, Units.IMPERIAL, ENGLISH) == imperial


def test_reverse_is_said_and_standing_has_no_direction() -> None:
    assert speed_text(2.0, Units.METRIC, ENGLISH) == "7.2"
    assert speed_text(-2.0, Units.METRIC, ENGLISH) == "R 7.2"
    assert speed_text(-0.001, Units.METRIC, ENGLISH) == "0.0"
    assert speed_text(2.0, Units.IMPERIAL, ENGLISH) == "4.5"
    assert {units: speed_unit(units) for units in Units} == {
        Units.METRIC: "km/h",
        Units.IMPERIAL: "mph",
        Units.JAPANESE: "km/h",
        Units.TAN: "km/h",
    }


@pytest.mark.parametrize(
    ("square_metres", "metric", "imperial", "japanese"),
    [
        (0.0, "0.00 ha", "0.00 ac", "0.0 a"),
        (34_212.0, "3.42 ha", "8.45 ac", "342 a"),
        (123_456.0, "12.3 ha", "30.5 ac", "1235 a"),
    ],
)
def test_an_area_is_counted_in_the_fields_own_unit(
    square_metres: float, metric: str, imperial: str, japanese: str
) -> None:
    assert area_text(square_metres, Units.METRIC, ENGLISH) == metric
    assert area_text(square_metres, Units.IMPERIAL, ENGLISH) == imperial
    assert area_text(square_metres, Units.JAPANESE, ENGLISH) == japanese


@pytest.mark.parametrize(
    ("square_metres", "english", "japanese"),
    [
        (0.0, "0.00 tan", "0.00 反"),
        (991.735537, "1.00 tan", "1.00 反"),
        (9_900.0, "9.98 tan", "9.98 反"),
        (9_917.35, "1.00 chō", "1.00 町"),
        (34_212.0, "3.45 chō", "3.45 町"),
    ],
)
def test_an_area_in_tan_and_cho(square_metres: float, english: str, japanese: str) -> None:
    assert area_text(square_metres, Units.TAN, ENGLISH) == english
    assert area_text(square_metres, Units.TAN, words_for("ja")) == japanese


def test_numbers_have_the_decimal_sign_of_the_language() -> None:
    spanish = words_for("es")
    assert offset_text(1.239, Units.METRIC, spanish) == "1,24 m"
    assert offset_text(0.9949, Units.IMPERIAL, spanish) == "3,3 ft"
    assert distance_text(1240.0, Units.METRIC, spanish) == "1,2 km"
    assert distance_text(1240.0, Units.IMPERIAL, spanish) == "0,8 mi"
    assert speed_text(-2.0, Units.METRIC, spanish) == "R 7,2"
    assert area_text(34_212.0, Units.METRIC, spanish) == "3,42 ha"
