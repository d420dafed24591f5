"""Standing at the start point: what is measured, what is refused; and the roll sensor's zero."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from support.drives_of_filters import Kit, measured, straight

from guidance_app.documents import Tractor
from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.initialisation import Initialisation, Progress
from guidance_app.estimation.reference_point import level_lever_arm
from guidance_app.estimation.roll_zero import CalibrationError, roll_zero
from guidance_app.model import FixQuality, Measurement, Pose

MILLIMETRE = 1e-3
CENTIMETRE = 0.01


def standing(seconds: float, *, rate: float = 10.0, white: float = 0.02, seed: int = 1) -> list[Measurement]:
    """A tractor that stands at (0.03, -0.04), its receiver 0.4 m to the east of the truth."""
    random = np.random.default_rng(seed)
    return [
        Measurement(
            t=k / rate,
            arrival=k / rate,
            east=0.43 + random.normal(0, white),
            north=-0.04 + random.normal(0, white),
            quality=FixQuality.DGPS,
            cell=(0.01, 0.01),
            speed=abs(random.normal(0, 0.02)),
            yaw_rate=0.004 + random.normal(0, 0.002),
        )
        for k in range(round(seconds * rate) + 1)
    ]


def initialised(measurements: list[Measurement], **more: object) -> Progress:
    run = Initialisation(**{"measuring_time": 10.0, **more})  # type: ignore[arg-type] # fields by name
    for z in measurements:
        run = run.with_measurement(z)
    return run.progress


def test_the_mean_against_the_known_start_point_is_the_correction():
    progress = initialised(standing(11), known=(0.03, -0.04))
    start = progress.start
    assert progress.done == 1.0
    assert start is not None
    assert (start.east, start.north) == (pytest.approx(-0.4, abs=CENTIMETRE), pytest.approx(0, abs=CENTIMETRE))
    assert start.seconds == pytest.approx(10, abs=0.11)
    assert start.samples == pytest.approx(101, abs=1)


def test_the_sample_covariance_and_the_gyros_bias_are_measured():
    start = initialised(standing(11)).start
    assert start is not None
    assert (start.east, start.north) == (0.0, 0.0)
    assert math.sqrt(start.covariance[0]) == pytest.approx(0.02, rel=0.25)
    assert math.sqrt(start.covariance[2]) == pytest.approx(0.02, rel=0.25)
    assert start.gyro_bias == pytest.approx(0.004, abs=0.0006)
    assert start.gyro_sigma == pytest.approx(0.002, rel=0.25)


def test_a_rounded_fix_that_never_changes_still_has_a_scatter():
    same = [replace(z, east=0.42, north=0.0, cell=(0.14, 0.18)) for z in standing(11)]
    start = initialised(same).start
    assert start is not None
    assert start.covariance[0] == pytest.approx(0.14**2 / 12)
    assert start.covariance[2] == pytest.approx(0.18**2 / 12)


def test_progress_grows_and_nothing_is_handed_out_before_the_end():
    run = Initialisation(10.0)
    last = -1.0
    for z in standing(9.5):
        run = run.with_measurement(z)
        assert run.progress.done >= last
        assert run.progress.start is None
        last = run.progress.done
    assert last == pytest.approx(0.95, abs=0.02)


def test_what_comes_later_does_not_change_a_finished_one():
    run = Initialisation(10.0)
    for z in standing(11):
        run = run.with_measurement(z)
    assert run.with_measurement(replace(standing(11)[0], t=99, east=50)) == run


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"speed": 1.0}, "moves at 3.6 km/h"),
        ({"yaw_rate": 0.2}, "turns"),
        ({"east": 2.0}, r"moved by 1\.\d m"),
        ({"quality": FixQuality.AUTONOMOUS}, "kind of fix has changed"),
    ],
)
def test_a_tractor_that_moves_is_refused_with_the_reason_and_begins_again(change: dict[str, object], reason: str):
    z = standing(25)
    run = Initialisation(10.0)
    for each in z[:80]:
        run = run.with_measurement(each)
    run = run.with_measurement(replace(z[80], **change))  # type: ignore[arg-type] # fields by name
    assert run.progress.done == 0.0
    assert run.progress.refused is not None
    assert re.search(reason, run.progress.refused)
    for each in z[81:]:
        run = run.with_measurement(each)
    assert run.progress.start is not None
    assert run.progress.refused is None


def test_no_measuring_time_is_done_at_once_and_corrects_nothing():
    start = Initialisation(0.0, known=(5.0, 5.0)).progress.start
    assert start is not None
    assert (start.east, start.north, start.samples) == (0.0, 0.0, 0)


def test_with_a_heading_it_is_the_reference_point_that_is_placed():
    z = [replace(each, antenna=(1.0, 0.0, 2.5), heading=math.pi / 2) for each in standing(11)]
    start = initialised(z, known=(0.03, -0.04)).start
    assert start is not None
    assert start.east == pytest.approx(0.6, abs=CENTIMETRE)


def test_a_filter_that_knows_the_gyros_bias_bridges_a_hole_better():
    """A bias of 1.7 degrees a second, known from the start or not, over 6 s without a fix."""
    truth = straight(duration=14, speed=1.5)
    z = [replace(each, yaw_rate=0.03) for each in measured(truth, Kit(gyro=True)) if not 3.0 < each.t < 9.0]
    start = initialised([replace(each, yaw_rate=0.03) for each in standing(11)]).start
    assert start is not None
    errors = []
    for knows in (False, True):
        estimator = make_filter("adaptive")
        if knows:
            estimator.begin(start)
        poses = [estimator.step(each) for each in z]
        known = [pose for pose in poses if pose is not None and pose.t > 2.0]
        errors.append(max(abs(math.remainder(pose.heading - 0.5, math.tau)) for pose in known))
    assert errors[1] < errors[0]
    assert errors[1] < math.radians(8)


# --- the roll sensor's zero ----------------------------------------------------------------------------------------

HEIGHT = 2.7


def driven(heading: float, sensor_error: float, *, length: float = 80.0, seed: int = 1) -> list[Pose]:
    """Poses of the line through the origin, as a roll sensor that shows ``sensor_error`` too much makes them."""
    random = np.random.default_rng(seed)
    shown = level_lever_arm((0.0, 0.0, HEIGHT), sensor_error, 0.0)
    poses = []
    for k in range(round(length / 0.3)):
        along = k * 0.3 - length / 2
        across = 0.03 * math.sin(along / 5) + random.normal(0, 0.01) - shown[1]
        poses.append(
            Pose(
                t=k * 0.2,
                arrival=k * 0.2,
                east=along * math.sin(heading) + across * math.cos(heading),
                north=along * math.cos(heading) - across * math.sin(heading),
                heading=heading % math.tau,
                speed=1.5,
            )
        )
    return poses


@pytest.mark.parametrize("error_deg", [-3.0, -0.35, 0.0, 0.35, 2.0])
@pytest.mark.parametrize("heading", [0.3, 2.0, 4.0])
def test_the_roll_zero_is_found_from_a_line_driven_both_ways(error_deg: float, heading: float):
    error = math.radians(error_deg)
    found = roll_zero(driven(heading, error), driven(heading + math.pi, error, seed=2), HEIGHT)
    assert found.correction_deg == pytest.approx(error_deg, abs=0.1)
    assert 0 < found.sigma_deg < 0.2
    assert found.metres == pytest.approx(80, abs=2)


def test_the_correction_added_to_the_documents_zero_puts_it_right():
    """A sensor that shows 2 degrees when level, in a document that says 0: the correction makes it 2."""
    error = math.radians(2.0)
    found = roll_zero(driven(0.3, error), driven(0.3 + math.pi, error, seed=2), HEIGHT)
    put_right = Tractor(name="tractor", roll_zero_deg=0.0 + found.correction_deg)
    assert put_right.roll_zero_deg == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(
    ("back", "height", "reason"),
    [
        (driven(0.3, 0.0), HEIGHT, "0 degrees to the first"),
        (driven(0.3 + math.pi, 0.0, length=20), HEIGHT, r"share 2\d m"),
        (driven(0.3 + math.pi, 0.0)[:5], HEIGHT, "hardly any fix"),
        ([replace(p, east=p.east + 2.0) for p in driven(0.3 + math.pi, 0.0)], HEIGHT, "same wheel tracks"),
        (driven(0.3 + math.pi, 0.0), 0.2, "nothing to calibrate"),
    ],
)
def test_drives_that_cannot_be_compared_are_refused_with_the_reason(back: list[Pose], height: float, reason: str):
    with pytest.raises(CalibrationError, match=reason):
        roll_zero(driven(0.3, 0.0), back, height)
