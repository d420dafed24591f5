"""The first heading, standing still, and the way driven: small judges on which the filters rest."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.drives_of_filters import FINE_CELL, Kit, drive, measured, straight

from guidance_app.angles import wrap_pi
from guidance_app.estimation.receiver_noise import fix_covariance, noise_of
from guidance_app.estimation.starting import Departure, Waiting
from guidance_app.estimation.stillness import Stillness
from guidance_app.estimation.travel import Travel
from guidance_app.model import FixQuality, Measurement

DEGREE = math.radians(1)


def first(measurements: list[Measurement], white: float = 0.008) -> tuple[int, Departure] | None:
    """After how many measurements a heading is told, and which."""
    waiting = Waiting()
    for k, z in enumerate(measurements):
        waiting = waiting.to(z)
        departure = waiting.departure(white)
        if departure is not None:
            return k + 1, departure
    return None


# --- the first heading ---------------------------------------------------------------------------------------------


@given(heading=st.floats(-3.1, 3.1), speed=st.floats(0.4, 4.0))
def test_a_straight_way_tells_the_heading_within_its_own_sigma(heading: float, speed: float):
    found = first(measured(straight(heading=heading, speed=speed, duration=8)))
    assert found is not None
    count, departure = found
    assert abs(wrap_pi(departure.heading - heading)) < 3.5 * departure.heading_sd
    assert abs(departure.speed - speed) < 3.5 * departure.speed_sd
    assert (count - 1) * 0.2 * speed > 0.4


def test_a_heading_sensor_tells_it_at_once():
    found = first(measured(straight(), Kit(compass=True)))
    assert found is not None
    assert found[0] == 1
    assert found[1].heading == pytest.approx(0.5, abs=2 * DEGREE)


def test_against_a_heading_sensor_the_course_tells_reverse():
    z = measured(straight(speed=-1.0), Kit(compass=True, velocity=True))
    found = first(z)
    assert found is not None
    assert found[1].speed < 0


def test_two_agreeing_courses_tell_it_and_two_that_differ_do_not():
    z = measured(straight(), Kit(velocity=True))
    found = first(z)
    assert found is not None
    assert found[0] == 2
    turned = [replace(each, course=(each.course or 0) + k * 1.5) for k, each in enumerate(z[:3])]
    assert first(turned) is None


def test_standing_tells_nothing_however_the_fix_wanders():
    random = np.random.default_rng(4)
    z = [
        Measurement(
            k * 0.2,
            k * 0.2,
            float(random.normal(0, 0.02)),
            float(random.normal(0, 0.02)),
            FixQuality.RTK_FIXED,
            FINE_CELL,
        )
        for k in range(500)
    ]
    assert first(z, white=0.02) is None


def test_an_outlier_among_the_first_fixes_costs_a_moment_and_not_the_heading():
    z = measured(straight(heading=1.0))
    z[0] = replace(z[0], east=z[0].east - 4.0)
    z[2] = replace(z[2], north=z[2].north + 3.0)
    found = first(z)
    assert found is not None
    assert abs(wrap_pi(found[1].heading - 1.0)) < 20 * DEGREE


def test_a_standstill_before_is_forgotten():
    z = measured(drive(lambda t: min(max(0.0, t - 20), 1.5), lambda _: 0.0, 40, heading=2.0))
    found = first(z)
    assert found is not None
    assert abs(wrap_pi(found[1].heading - 2.0)) < 20 * DEGREE
    assert found[0] > 100


# --- standing still ------------------------------------------------------------------------------------------------


def judged(measurements: list[Measurement], white: float = 0.008) -> list[float | None]:
    still = Stillness.of(measurements[0])
    bounds = []
    for z in measurements:
        still = still.after(z, white)
        bounds.append(still.speed_bound(z, white))
    return bounds


def test_a_low_speed_for_half_a_second_is_standing_and_one_reading_does_not_end_it():
    z = measured(straight(speed=0.0, duration=4), Kit(velocity=True))
    z = [replace(each, speed=0.03) for each in z]
    z[12] = replace(z[12], speed=0.2)
    bounds = judged(z)
    assert bounds[:2] == [None, None]
    assert all(bound is not None for bound in bounds[4:])
    z[13] = replace(z[13], speed=0.2)
    assert judged(z)[13] is None
    z[13] = replace(z[13], speed=0.03)
    z[12] = replace(z[12], speed=0.5)
    assert judged(z)[12] is None


def test_without_a_speed_a_held_fix_bounds_it_the_longer_the_tighter():
    bounds = judged(measured(straight(speed=0.0, duration=10)))
    known = [bound for bound in bounds if bound is not None]
    assert bounds[4] is None
    assert len(known) == len(bounds) - 5
    assert known == sorted(known, reverse=True)
    assert known[-1] < 0.02


def test_a_moving_tractor_is_not_taken_to_stand():
    for kit in (Kit(), Kit(velocity=True), Kit(cell=FINE_CELL, white=0.005)):
        assert not any(judged(measured(straight(speed=1.0), kit)))


# --- the way driven ------------------------------------------------------------------------------------------------


def travelled(points: list[tuple[float, float]], compass: float | None = None) -> Travel:
    travel = Travel()
    for east, north in points:
        travel = travel.to(east, north, compass)
    return travel


def line(start: tuple[float, float], heading: float, metres: float, step: float = 0.3) -> list[tuple[float, float]]:
    return [
        (start[0] + k * step * math.sin(heading), start[1] + k * step * math.cos(heading))
        for k in range(1, round(metres / step) + 1)
    ]


@given(heading=st.floats(-3.1, 3.1))
def test_a_metre_tells_the_heading(heading: float):
    travel = travelled(line((0, 0), heading, 3))
    assert travel.heading is not None
    assert wrap_pi(travel.heading - heading) == pytest.approx(0, abs=1e-6)
    assert not travel.reverse
    assert travelled(line((0, 0), heading, 0.9)).heading is None


@given(heading=st.floats(-3.1, 3.1))
def test_turning_round_on_the_spot_is_backing_up_and_thirty_metres_of_it_are_not_believed(heading: float):
    there = line((0, 0), heading, 12)
    back = line(there[-1], heading + math.pi, 60)
    early, late = travelled(there + back[:20]), travelled(there + back)
    assert early.reverse
    assert early.heading is not None
    assert wrap_pi(early.heading - heading) == pytest.approx(0, abs=1e-6)
    assert not late.reverse
    assert late.heading is not None
    assert wrap_pi(late.heading - heading - math.pi) == pytest.approx(0, abs=1e-6)


def test_a_compass_decides_which_way_is_forward():
    travel = travelled(line((0, 0), 0.0, 5), compass=math.pi)
    assert travel.reverse
    assert travel.heading == math.pi


def test_an_outlier_is_neither_a_baseline_nor_a_reversal():
    points = line((0, 0), 0.5, 10)
    points.insert(20, (points[19][0] + 6.0, points[19][1] - 4.0))
    headings = []
    travel = Travel()
    for point in points:
        travel = travel.to(*point)
        headings.append(travel.heading)
        assert not travel.reverse
    assert all(heading is None or abs(wrap_pi(heading - 0.5)) < 15 * DEGREE for heading in headings)


def test_what_is_kept_stays_short_in_a_day_of_standing():
    travel = travelled(line((0, 0), 0.5, 5))
    for k in range(5000):
        travel = travel.to(2.0 + 0.2 * (k % 2), 4.0)
    assert travel.kept <= 64


# --- the receiver's noise ------------------------------------------------------------------------------------------


def test_the_receivers_own_estimate_wins_over_the_table():
    z = Measurement(0, 0, 0, 0, FixQuality.DGPS, (0.14, 0.18))
    assert noise_of(replace(z, sigma=(0.7, 0.7))).drift == pytest.approx(0.7)
    fixed = replace(z, quality=FixQuality.RTK_FIXED)
    assert noise_of(replace(fixed, sigma=(0.02, 0.02))).white == pytest.approx(0.02)
    assert noise_of(fixed).drift == 0.0


@pytest.mark.parametrize("quality", FixQuality)
def test_every_quality_has_a_noise_and_a_worse_one_a_larger(quality: FixQuality):
    z = Measurement(0, 0, 0, 0, quality)
    assert fix_covariance(z)[0] > 0
    assert fix_covariance(z)[0] >= fix_covariance(replace(z, quality=FixQuality.RTK_FIXED))[0]
