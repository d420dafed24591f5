"""Typed coordinates in every usual spelling, systems there and back, and what is refused with which sentence."""

import contextlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from guidance_app import geodesy
from guidance_app.coordinates import CornerError, corner_text, parse_corner, read_coordinate
from guidance_app.geodesy import CoordinateSystem, Datum, DatumError, Projection, crs_named, lonlat_from, lonlat_to

TENTH_OF_A_MILLIMETRE_DEG = 1e-9
DEGREES = CoordinateSystem()
TOKYO = CoordinateSystem(datum=Datum.TOKYO)
UTM32 = CoordinateSystem(Projection.UTM, zone=32)
ZONE9 = CoordinateSystem(Projection.PLANE_RECTANGULAR, zone=9)
JAPANESE = [
    CoordinateSystem(projection, datum, zone)
    for datum in Datum
    for projection, zone in ((Projection.UTM, 54), (Projection.PLANE_RECTANGULAR, 9), (Projection.GEOGRAPHIC, None))
]


@pytest.mark.parametrize(
    "text",
    [
        "54.58, 10.2", "54,58 10,2", "54,58; 10,2", "54,58,10,2", "54.58\t10.2", "54.58 10.2",
        "10.2E 54.58N", "N54.58 E10.2",
        "N 54° 34.8' E 10° 12'", "54°34'48\"N 10°12'00\"E", "54° 34' 48\" 10° 12' 0\"", "54-34-48N, 10-12-00E",
        "54 34 48 10 12 0", "54:34:48 N; 10:12:00 E", "北緯54度34分48秒 東経10度12分0秒", "５４．５８，１０．２",
        "lat 54.58 lon 10.2",
        "lon=10.2, lat=54.58", "54°34′48″N, 10°12′0″E", "+54.58, +10.2",
    ],
)  # fmt: skip
def test_every_usual_spelling_is_read(text: str) -> None:
    corner = parse_corner(text, DEGREES)
    assert (corner.latitude_deg, corner.longitude_deg) == (pytest.approx(54.58), pytest.approx(10.2))
    assert corner.said.startswith("latitude 54.58, longitude 10.2")


def test_south_and_west_are_negative_and_an_impossible_latitude_turns_the_pair() -> None:
    corner = parse_corner("S33 51.2 W070 12.1", DEGREES)
    assert corner.latitude_deg == pytest.approx(-33.8533333)
    assert corner.longitude_deg == pytest.approx(-70.2016667)
    assert parse_corner("140.026, 38.54", DEGREES).latitude_deg == 38.54
    assert parse_corner("41.93, -4.87", DEGREES, order="east first").longitude_deg == 41.93


@pytest.mark.parametrize(
    ("text", "system", "sentence"),
    [
        ("", DEGREES, "not two coordinates"),
        ("54.5", DEGREES, "not two coordinates"),
        ("a, b", DEGREES, "'a' is not a coordinate"),
        (", 5.0", DEGREES, "is missing"),
        ("54 61 2 10 0 0", DEGREES, "61 minutes; they go up to 59"),
        ("54 10 60; 10", DEGREES, "60 seconds"),
        ("54.5 10.2 N; 10", DEGREES, "decimals before its last part"),
        ("N54S; 10", DEGREES, "names its side twice"),
        ("-54N; 10", DEGREES, "both a minus and a letter"),
        ("10.5O 54.2N", DEGREES, "O means east in German"),
        ("10N 54N", DEGREES, "the letters say"),
        ("95, 100", DEGREES, "not on earth"),
        ("500000; 5400000", DEGREES, "look like metres"),
        ("54.1, 10.2", UTM32, "look like degrees"),
        ("54°; 10", UTM32, "is not a coordinate"),
        ("5e9; 3", ZONE9, "is not a coordinate"),
        ("2000000, 12034", ZONE9, "outside of every plane rectangular zone"),
    ],
)
def test_what_is_no_corner_is_one_clear_sentence(text: str, system: CoordinateSystem, sentence: str) -> None:
    with pytest.raises(CornerError, match=sentence):
        parse_corner(text, system)


def test_a_forced_order_that_puts_the_latitude_off_earth_says_so() -> None:
    with pytest.raises(CornerError, match="the two look swapped"):
        parse_corner("54.5, 140.2", DEGREES, order="east first")


def test_plane_coordinates_know_their_usual_orders() -> None:
    for text in ("612345.123, 6050000.5", "6050000.5 612345.123", "N 6050000.5 E 612345.123", "612345,123; 6050000,5"):
        corner = parse_corner(text, UTM32)
        assert corner_text(corner.latitude_deg, corner.longitude_deg, UTM32) == "612345.123 E, 6050000.500 N"
    for text in ("-36258.1, 12034.5", "X=-36258.1 Y=12034.5", "Y 12034.5 X -36258.1", "-36,258.100; 12,034.5"):
        corner = parse_corner(text, ZONE9)
        assert corner_text(corner.latitude_deg, corner.longitude_deg, ZONE9) == "X -36258.100, Y 12034.500"
        assert "X -36258.100 m north, Y 12034.500 m east in Japanese plane rectangular zone 9" in corner.said


def test_shown_degrees_and_dms_are_read_back() -> None:
    assert corner_text(54.58, -10.2, DEGREES) == "54.580000000, -10.200000000"
    text = corner_text(54.58, -10.2, DEGREES, dms=True)
    assert text == "54° 34' 48.00000\" N, 10° 12' 00.00000\" W"
    assert parse_corner(text, DEGREES).longitude_deg == pytest.approx(-10.2)


@given(st.floats(20, 46), st.floats(123, 153), st.sampled_from([False, True]))
def test_what_is_shown_is_what_is_typed(latitude: float, longitude: float, dms: bool) -> None:
    text = corner_text(latitude, longitude, DEGREES, dms=dms)
    corner = parse_corner(text, DEGREES)
    assert corner.latitude_deg == pytest.approx(latitude, abs=5 * TENTH_OF_A_MILLIMETRE_DEG)
    assert corner.longitude_deg == pytest.approx(longitude, abs=5 * TENTH_OF_A_MILLIMETRE_DEG)


@given(st.text(max_size=30), st.sampled_from([DEGREES, UTM32, ZONE9]))
def test_any_text_is_a_corner_or_one_sentence(text: str, system: CoordinateSystem) -> None:
    with contextlib.suppress(CornerError):
        corner = parse_corner(text, system)
        assert abs(corner.latitude_deg) <= 90
        assert math.isfinite(corner.longitude_deg)


# --- systems ---------------------------------------------------------------------------------------------------------

OFFICIAL_TOKYO, OFFICIAL_WORLD = (140.026224, 38.546789), (140.022853531, 38.549703478)
GRID_ROUNDING_DEG = 2e-9
"""0.2 mm: the grid's parameters are rounded to 1e-5 second, and the official program adds them up in its own order."""


def test_the_tokyo_datum_meets_the_check_point() -> None:
    there = lonlat_from(TOKYO)(np.array([OFFICIAL_TOKYO]))[0]
    assert there == pytest.approx(OFFICIAL_WORLD, abs=GRID_ROUNDING_DEG)
    assert lonlat_to(TOKYO)(np.array([there]))[0] == pytest.approx(OFFICIAL_TOKYO, abs=1e-12)


@pytest.mark.parametrize("system", JAPANESE, ids=lambda one: one.words)
def test_each_system_there_and_back(system: CoordinateSystem) -> None:
    places = np.array([[140.02, 38.54], [139.7, 35.6], [140.5, 36.4]])
    assert np.abs(lonlat_from(system)(lonlat_to(system)(places)) - places).max() < TENTH_OF_A_MILLIMETRE_DEG


def test_zone_origins_are_where_the_law_puts_them() -> None:
    """Zone 9 has its origin at 36 N, 139 50 E; X is north."""
    origin = lonlat_to(ZONE9)(np.array([[139 + 50 / 60, 36.0]]))[0]
    assert np.abs(origin).max() < 1e-3
    north = lonlat_to(ZONE9)(np.array([[139 + 50 / 60, 36.1]]))[0]
    assert north[1] > 11_000
    assert abs(north[0]) < 1e-3
    assert [CoordinateSystem(Projection.PLANE_RECTANGULAR, zone=zone).epsg for zone in (1, 19)] == [6669, 6687]


def test_tokyo_without_the_grid_is_refused_unless_nine_metres_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(geodesy, "_grid", lambda: None)
    text = "38.546789, 140.026224"
    with pytest.raises(CornerError, match="only within 9 m") as caught:
        parse_corner(text, TOKYO)
    assert caught.value.inexact
    corner = parse_corner(text, TOKYO, inexact=True)
    off = math.hypot(
        (corner.latitude_deg - OFFICIAL_WORLD[1]) * 111e3, (corner.longitude_deg - OFFICIAL_WORLD[0]) * 87e3
    )
    assert 0.1 < off < geodesy.TOKYO_WITHOUT_GRID
    with pytest.raises(CornerError, match="confirm to see it so"):
        corner_text(38.5, 140.0, TOKYO)
    assert corner_text(corner.latitude_deg, corner.longitude_deg, TOKYO, inexact=True).startswith("38.54678")


def test_tokyo_outside_the_grid_is_refused_too() -> None:
    with pytest.raises(DatumError, match="ends before here"):
        lonlat_from(TOKYO)(np.array([[10.0, 50.0]]))


def test_other_datums_say_how_far_off_they_are() -> None:
    with pytest.raises(DatumError, match="only within 4 m") as caught:
        lonlat_from(crs_named("EPSG:4269"))
    assert caught.value.accuracy == 4
    assert lonlat_from(crs_named("EPSG:4269"), inexact=True)(np.array([[-100.0, 40.0]])).shape == (1, 2)
    with pytest.raises(ValueError, match="is not known"):
        crs_named("EPSG:999999")


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: CoordinateSystem(Projection.UTM), "zones go from 1 to 60; none was given"),
        (lambda: CoordinateSystem(Projection.UTM, zone=61), "61 was given"),
        (lambda: CoordinateSystem(Projection.UTM, Datum.TOKYO, 33), "from 51 to 55"),
        (lambda: CoordinateSystem(Projection.PLANE_RECTANGULAR, zone=20), "from 1 to 19"),
        (lambda: CoordinateSystem(zone=3), "degrees have no zone"),
        (lambda: CoordinateSystem(Projection.PLANE_RECTANGULAR, zone=9, south=True), "southern hemisphere"),
    ],
)
def test_zones_that_do_not_exist_are_refused(make: object, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        make()  # type: ignore[operator]  # each is a function


def test_a_single_coordinate_tells_its_axis() -> None:
    assert read_coordinate("N 54 34.5").axis == "north"
    assert read_coordinate("12.5").axis is None
    assert read_coordinate("54° 34' 50,5\"").decimal_comma
    assert read_coordinate("1234,5", plane=True).value == 1234.5
