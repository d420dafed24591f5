"""One battery for all filters: what every one of them promises, whatever its model is."""

import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from support.drives_of_filters import (
    KITS,
    KMH,
    PAPER_CELL,
    Kit,
    Moment,
    drive,
    heading_error,
    measured,
    mirrored,
    position_error,
    rms,
    straight,
)

from guidance_app.estimation import filters
from guidance_app.estimation.filter import Filter, Start
from guidance_app.estimation.filters import FILTERS, make_filter
from guidance_app.model import FixQuality, Measurement, Pose

CENTIMETRE = 0.01
MILLIMETRE = 1e-3
DEGREE = math.radians(1)

EVERY = pytest.mark.parametrize("name", FILTERS)
EVERY_KIT = pytest.mark.parametrize("kit", KITS.values(), ids=KITS.keys())
MODELLED = pytest.mark.parametrize("name", [name for name in FILTERS if name != "off"])


def run(name: str, measurements: list[Measurement]) -> list[Pose]:
    estimator = make_filter(name)
    poses = [estimator.step(z) for z in measurements]
    assert all(pose is not None for pose in poses)
    return [pose for pose in poses if pose is not None]


def settled(poses: list[Pose], truth: list[Moment], after: float = 8.0) -> list[tuple[Pose, Moment]]:
    return [(pose, moment) for pose, moment in zip(poses, truth, strict=True) if moment.t >= after]


def test_the_table_holds_every_filter_of_the_folder():
    folder = Path(str(filters.__file__)).parent
    assert {path.stem for path in folder.glob("*.py")} - {"__init__"} == set(FILTERS)


def test_an_unknown_name_is_refused_and_the_known_ones_are_named():
    with pytest.raises(ValueError, match=r"'best'.*off.*quantisation_kf"):
        make_filter("best")


# --- straight on ---------------------------------------------------------------------------------------------------


@EVERY
@EVERY_KIT
@pytest.mark.parametrize("heading", [0.5, 2.9, math.pi, 4.4, 6.2])
def test_a_straight_line_converges(name: str, kit: Kit, heading: float):
    truth = straight(heading=heading, duration=30)
    pairs = settled(run(name, measured(truth, kit)), truth)
    drift = 5 * CENTIMETRE if kit.quality is FixQuality.DGPS else 0.0
    limit = 8 * CENTIMETRE if name == "off" else 6.5 * CENTIMETRE
    assert rms(position_error(pose, moment) for pose, moment in pairs) < limit + drift
    if name != "off":
        blind = name == "gyro_ekf" and not (kit.gyro or kit.compass)
        limit = 2.5 * DEGREE if blind else 1.5 * DEGREE
        assert rms(heading_error(pose, moment) for pose, moment in pairs) < limit
        assert rms(pose.speed - moment.speed for pose, moment in pairs) < 0.1


@MODELLED
def test_filtering_is_better_than_not_filtering_on_a_straight_line(name: str):
    truth = straight(duration=60)
    z = measured(truth)
    errors = {
        each: rms(position_error(pose, moment) for pose, moment in settled(run(each, z), truth))
        for each in (name, "off")
    }
    assert errors[name] < 0.8 * errors["off"]


@EVERY
@pytest.mark.parametrize("rate", [1.0, 10.0])
def test_a_receiver_of_1_or_10_hz_serves(name: str, rate: float):
    truth = straight(duration=40, rate=rate, speed=2.0)
    pairs = settled(run(name, measured(truth)), truth, after=15)
    assert rms(position_error(pose, moment) for pose, moment in pairs) < 8 * CENTIMETRE
    assert rms(heading_error(pose, moment) for pose, moment in pairs) < 8 * DEGREE


@EVERY
def test_north_is_crossed_without_a_spin(name: str):
    """A gentle bend from 10 degrees west of north to 10 degrees east of it, and the same at south."""
    for middle in (0.0, math.pi):
        truth = drive(lambda _: 2.0, lambda _: 0.35 / 80, 40, heading=middle - 0.175)
        pairs = settled(run(name, measured(truth, Kit(velocity=True))), truth)
        assert max(heading_error(pose, moment) for pose, moment in pairs) < 15 * DEGREE
        assert all(0.0 <= pose.heading < math.tau for pose, _ in pairs)


# --- the covariance ------------------------------------------------------------------------------------------------


@EVERY
@EVERY_KIT
def test_the_covariance_is_positive_and_finite(name: str, kit: Kit):
    truth = drive(lambda t: min(t, 2.0), lambda t: 0.1 if 20 < t < 30 else 0.0, 60)
    for pose in run(name, measured(truth, kit)):
        assert pose.covariance is not None
        east, cross, north = pose.covariance
        assert 0 < east < 100
        assert 0 < north < 100
        assert cross * cross < east * north
        if pose.heading_sigma is not None:
            assert 0 < pose.heading_sigma < 4


# --- time ----------------------------------------------------------------------------------------------------------


@EVERY
@EVERY_KIT
def test_a_repeated_or_older_epoch_changes_nothing(name: str, kit: Kit):
    z = measured(straight(duration=20), kit)
    with_repeats = [again for each in z for again in (each, each, replace(each, t=each.t - 0.15))]
    assert run(name, with_repeats)[0::3] == run(name, z)
    assert run(name, with_repeats)[1::3] == run(name, z)
    assert run(name, with_repeats)[2::3] == run(name, z)


@EVERY
@EVERY_KIT
@pytest.mark.parametrize("gap", [0.3, 2.0, 8.0, 60.0, 600.0])
def test_a_gap_is_survived(name: str, kit: Kit, gap: float):
    truth = straight(duration=50)
    before = [moment for moment in truth if moment.t <= 20]
    after = [replace_time(moment, moment.t + gap - 0.2, truth, gap) for moment in truth if moment.t > 20]
    moments = before + after
    pairs = settled(run(name, measured(moments, kit)), moments, after=20 + gap + 12)
    drift = 8 * CENTIMETRE if kit.quality is FixQuality.DGPS else 0.0
    assert rms(position_error(pose, moment) for pose, moment in pairs) < 9 * CENTIMETRE + drift
    assert all(pose.heading_known for pose, _ in pairs)
    if name != "off":
        assert rms(heading_error(pose, moment) for pose, moment in pairs) < 3 * DEGREE


def replace_time(moment: Moment, t: float, truth: list[Moment], gap: float) -> Moment:
    """The moment as if the tractor had gone on through the gap."""
    way = (gap - 0.2) * moment.speed
    heading = truth[0].heading
    return replace(
        moment, t=t, east=moment.east + way * math.sin(heading), north=moment.north + way * math.cos(heading)
    )


# --- what a receiver does to one -----------------------------------------------------------------------------------


@EVERY
@EVERY_KIT
def test_a_single_outlier_is_forgotten(name: str, kit: Kit):
    truth = straight(duration=40)
    z = measured(truth, kit)
    z[100] = replace(z[100], east=z[100].east + 3.0)
    poses = run(name, z)
    if name in ("adaptive", "gyro_ekf"):
        assert position_error(poses[100], truth[100]) < 0.35
        assert poses[100].dead_reckoned
    pairs = settled(poses, truth, after=28)
    assert rms(position_error(pose, moment) for pose, moment in pairs) < 12 * CENTIMETRE


@EVERY
@EVERY_KIT
def test_standing_the_heading_does_not_turn_and_the_position_does_not_crawl(name: str, kit: Kit):
    truth = drive(lambda t: 1.5 if t < 20 else max(0.0, 1.5 - 0.5 * (t - 20)), lambda _: 0.0, 90)
    poses = [pose for pose in run(name, measured(truth, kit)) if pose.t > 30]
    headings = [math.remainder(pose.heading - poses[0].heading, math.tau) for pose in poses]
    assert max(map(abs, headings)) < {"off": 35, "quantisation_kf": 6}.get(name, 3) * DEGREE
    spread = max(math.hypot(pose.east - poses[0].east, pose.north - poses[0].north) for pose in poses)
    assert spread < 3 * CENTIMETRE + 6 * kit.white
    assert all(abs(pose.speed) < 0.2 for pose in poses[20:])
    if name == "adaptive":
        assert all(pose.standing for pose in poses[20:])


@EVERY
@EVERY_KIT
def test_backing_up_the_heading_stays_and_the_speed_is_negative(name: str, kit: Kit):
    truth = drive(lambda t: 1.5 if t < 20 else (0.0 if t < 23 else -1.0), lambda _: 0.0, 33)
    poses = run(name, measured(truth, kit))
    late = [pose for pose in poses if pose.t > 28]
    assert all(pose.speed < -0.5 for pose in late)
    assert all(pose.reverse for pose in late)
    assert all(heading_error(pose, moment) < 20 * DEGREE for pose, moment in settled(poses, truth, after=28))


@EVERY
def test_a_start_in_reverse_is_put_right_within_40_m(name: str):
    """Without a heading sensor the first metres are taken for forward; nobody backs up for more than 30 m."""
    truth = drive(lambda t: -1.0 if t < 8 else 2.0, lambda _: 0.0, 40)
    poses = run(name, measured(truth))
    assert heading_error(poses[-1], truth[-1]) < 10 * DEGREE
    assert poses[-1].speed > 1.5


@EVERY
@EVERY_KIT
def test_the_start_does_not_spin(name: str, kit: Kit):
    """Ten seconds of standing, then off: no heading before there is one, and the first is near the truth."""
    truth = drive(lambda t: min(max(t - 10, 0.0) * 0.5, 1.5), lambda _: 0.0, 40)
    poses = run(name, measured(truth, kit))
    for pose, moment in zip(poses, truth, strict=True):
        if pose.heading_known and pose.heading_sigma is not None:
            assert heading_error(pose, moment) < 25 * DEGREE
        if moment.t < 10 and not kit.compass:
            assert not pose.heading_known
        if moment.t > 14:
            assert pose.heading_known


# --- geometry ------------------------------------------------------------------------------------------------------


@EVERY
@EVERY_KIT
def test_a_mirrored_world_gives_the_mirrored_estimate(name: str, kit: Kit):
    truth = drive(lambda t: 1.5 if t < 40 else -1.0, lambda t: 0.12 if 15 < t < 30 else 0.0, 50)
    z = measured(truth, replace(kit, antenna=(0.6, 0.2, 2.5)))
    for pose, image in zip(run(name, z), run(name, [mirrored(each) for each in z]), strict=True):
        assert image.east == pytest.approx(-pose.east, abs=MILLIMETRE)
        assert image.north == pytest.approx(pose.north, abs=MILLIMETRE)
        assert math.remainder(image.heading + pose.heading, math.tau) == pytest.approx(0, abs=1e-3 * DEGREE)
        assert image.speed == pytest.approx(pose.speed, abs=MILLIMETRE)
        assert image.curvature == pytest.approx(-pose.curvature, abs=1e-4)


@MODELLED
def test_the_antennas_lever_arm_is_taken_off(name: str):
    arm = (1.2, -0.4, 2.6)
    truth = straight(duration=40, heading=2.0)
    kit = Kit(cell=(0.01, 0.01), velocity=True, compass=True, antenna=arm)
    pairs = settled(run(name, measured(truth, kit)), truth)
    assert rms(position_error(pose, moment) for pose, moment in pairs) < 3 * CENTIMETRE


def test_the_antennas_swing_is_not_taken_for_a_slip():
    """An antenna 2 m ahead of the axle moves 22 degrees outwards in this turn; the body does not."""
    truth = drive(lambda _: 1.5, lambda t: 0.2 if t > 10 else 0.0, 30)
    kit = Kit(velocity=True, gyro=True, antenna=(2.0, 0.0, 2.5))
    pairs = settled(run("adaptive", measured(truth, kit)), truth)
    assert rms(heading_error(pose, moment) for pose, moment in pairs) < 2 * DEGREE
    assert rms(position_error(pose, moment) for pose, moment in pairs) < 8 * CENTIMETRE


# --- copies --------------------------------------------------------------------------------------------------------


@EVERY
@EVERY_KIT
def test_a_fork_and_its_origin_do_not_touch_each_other(name: str, kit: Kit):
    z = measured(drive(lambda _: 1.5, lambda t: 0.1 if t > 15 else 0.0, 30), kit)
    whole = run(name, z)
    estimator: Filter = make_filter(name)
    for each in z[:70]:
        estimator.step(each)
    fork = estimator.fork()
    forked = [fork.step(each) for each in z[70:]]
    straight_on = [estimator.step(replace(each, east=each.east + 50)) for each in z[70:]]
    assert forked == whole[70:]
    assert straight_on != forked
    again = estimator.fork()
    assert again.step(z[-1]) == estimator.fork().step(z[-1])


@EVERY
def test_what_is_learnt_at_the_start_point_is_taken(name: str):
    estimator = make_filter(name)
    estimator.begin(Start(0.0, 0.0, (4e-4, 0.0, 4e-4), 0.004, 0.002, 10.0, 50))
    for z in measured(straight(), KITS["velocity and gyro"]):
        assert estimator.step(z) is not None
    fork = estimator.fork()
    assert fork.step(measured(straight())[0]) is not None


@EVERY
def test_the_scatter_found_at_the_start_point_widens_the_ellipse(name: str):
    """Fixes that scattered by 15 cm while standing are not believed to the centimetre while driving."""
    z = measured(straight())
    plain, taught = make_filter(name), make_filter(name)
    taught.begin(Start(0.0, 0.0, (0.15**2, 0.0, 0.15**2), None, None, 10.0, 50))
    for each in z:
        before, after = plain.step(each), taught.step(each)
    assert before is not None
    assert after is not None
    assert before.covariance is not None
    assert after.covariance is not None
    assert after.covariance[0] + after.covariance[2] > 1.1 * (before.covariance[0] + before.covariance[2])
    later = replace(z[-1], t=z[-1].t + 0.2)
    assert taught.fork().step(later) == taught.step(later)


@pytest.mark.parametrize("name", ["adaptive", "gyro_ekf"])
def test_the_gyros_bias_found_at_the_start_point_is_taken_off(name: str):
    """A gyro 1 degree a second off, on fixes too coarse to see it soon."""
    biased = [replace(each, yaw_rate=math.radians(1.0)) for each in measured(straight(duration=12), Kit(velocity=True))]
    plain, taught = make_filter(name), make_filter(name)
    taught.begin(Start(0.0, 0.0, (1e-4, 0.0, 1e-4), math.radians(1.0), 1e-4, 10.0, 50))
    ways = [[estimator.step(each) for each in biased] for estimator in (plain, taught)]
    off = [rms(math.remainder(pose.heading - 0.5, math.tau) for pose in way[15:] if pose) for way in ways]
    assert off[1] < off[0]
    assert off[1] < 2 * DEGREE


# --- anything finite -----------------------------------------------------------------------------------------------


def wild(random: np.random.Generator, t: float) -> Measurement:
    """A measurement that only promises to be finite."""

    def maybe(low: float, high: float) -> float | None:
        return float(random.uniform(low, high)) if random.random() < 0.5 else None

    cell = [None, (0.0, 0.0), PAPER_CELL, (1.4, 1.8), (1e-9, 1e-9)][int(random.integers(5))]
    return Measurement(
        t=t,
        arrival=t,
        east=float(random.normal(0, 10 ** random.uniform(-3, 4))),
        north=float(random.normal(0, 10 ** random.uniform(-3, 4))),
        quality=FixQuality(int(random.integers(9))),
        cell=cell,
        sigma=None if random.random() < 0.7 else (float(random.uniform(0, 30)), 0.0),
        speed=maybe(0, 40),
        course=maybe(0, math.tau),
        heading=maybe(0, math.tau),
        heading_sigma=maybe(0.001, 0.2),
        yaw_rate=maybe(-30, 30),
        antenna=(float(random.uniform(-5, 5)), float(random.uniform(-2, 2)), 2.5),
    )


@EVERY
@pytest.mark.parametrize("seed", range(6))
def test_no_finite_measurement_breaks_it(name: str, seed: int):
    random = np.random.default_rng(seed)
    estimator = make_filter(name)
    t = 0.0
    for _ in range(300):
        t += float(random.choice([0.0, 1e-9, 0.1, 0.2, 1.0, 9.0, 700.0, -5.0]))
        pose = estimator.step(wild(random, t))
        assert pose is not None
        for field in fields(pose):
            value = getattr(pose, field.name)
            assert not isinstance(value, float) or math.isfinite(value), field.name
        assert pose.covariance is not None
        assert all(math.isfinite(part) for part in pose.covariance)


BRAKING = drive(
    lambda t: min(max(t - 5, 0.0) * 1.5, 6.0) if t < 30 else max(6.0 - 3.0 * (t - 30), 0.0) + max(t - 45, 0.0),
    lambda _: 0.0,
    52,
    rate=1.0,
)
"""Off with 1.5 m/s2, on at 22 km/h, a hard stop within 2 s, ten seconds of standing, off again; a fix a second."""


@pytest.mark.parametrize("quality", [FixQuality.RTK_FIXED, FixQuality.DGPS])
@pytest.mark.parametrize("velocity", [False, True], ids=["position", "velocity"])
def test_a_hard_stop_at_1_hz_is_not_driven_past(velocity: bool, quality: FixQuality):
    poses = run("adaptive", measured(BRAKING, Kit(velocity=velocity, quality=quality)))
    for pose, moment in zip(poses, BRAKING, strict=True):
        assert position_error(pose, moment) < 0.25
        assert not pose.dead_reckoned
        assert pose.covariance is not None
        sigma = math.sqrt(pose.covariance[0] + pose.covariance[2])
        assert position_error(pose, moment) < 4 * sigma
        if moment.t > 15 and pose.heading_known:
            assert heading_error(pose, moment) < 20 * DEGREE


@pytest.mark.parametrize("rate", [1.0, 5.0])
def test_an_outlier_to_the_side_is_refused_at_any_rate(rate: float):
    """Ahead at 1 Hz it may be the driver's doing; to the side no tractor gets so far."""
    truth = straight(duration=60, heading=0.0, rate=rate)
    z = measured(truth)
    k = round(40 * rate)
    z[k] = replace(z[k], east=z[k].east + 2.0)
    pose = run("adaptive", z)[k]
    assert pose.dead_reckoned
    assert position_error(pose, truth[k]) < 0.25


@EVERY
def test_after_a_shower_of_outliers_it_finds_back(name: str):
    truth = straight(duration=60, speed=5 * KMH)
    z = measured(truth)
    random = np.random.default_rng(5)
    for k in range(100, 130):
        z[k] = replace(z[k], east=z[k].east + random.normal(0, 20), north=z[k].north + random.normal(0, 20))
    pairs = settled(run(name, z), truth, after=42)
    assert rms(position_error(pose, moment) for pose, moment in pairs) < 12 * CENTIMETRE
