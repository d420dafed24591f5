"""The offline smoother: better than any causal filter, honest, and safe on anything finite."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from support.drives_of_filters import (
    KITS,
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

from guidance_app.estimation.filters import make_filter
from guidance_app.estimation.smoothing import smooth
from guidance_app.model import FixQuality, Measurement, Pose

CENTIMETRE = 0.01
MILLIMETRE = 1e-3
DEGREE = math.radians(1)


def s_bend() -> list[Moment]:
    return drive(lambda _: 1.5, lambda t: 0.1 if 15 < t < 25 else (-0.1 if 30 < t < 40 else 0.0), 50)


def pairs(poses: tuple[Pose, ...], truth: list[Moment]) -> list[tuple[Pose, Moment]]:
    assert [pose.t for pose in poses] == [moment.t for moment in truth]
    return list(zip(poses, truth, strict=True))


@pytest.mark.parametrize("kit", KITS.values(), ids=KITS.keys())
def test_it_is_better_than_the_causal_filter(kit: Kit):
    truth = s_bend()
    z = measured(truth, kit)
    smoothed = pairs(smooth(z), truth)
    estimator = make_filter("adaptive")
    causal = [(pose, moment) for each, moment in zip(z, truth, strict=True) if (pose := estimator.step(each))]
    late = [pair for pair in causal if pair[1].t > 5]
    assert rms(heading_error(*pair) for pair in smoothed) < rms(heading_error(*pair) for pair in late)
    if kit.quality is FixQuality.RTK_FIXED:
        assert rms(position_error(*pair) for pair in smoothed) < rms(position_error(*pair) for pair in late)


def test_a_mirrored_world_gives_the_mirrored_track():
    truth = s_bend()
    z = measured(truth, replace(KITS["velocity and gyro"], antenna=(0.6, 0.2, 2.5)))
    for one, other in zip(smooth(z), smooth([mirrored(each) for each in z]), strict=True):
        assert other.east == pytest.approx(-one.east, abs=MILLIMETRE)
        assert other.north == pytest.approx(one.north, abs=MILLIMETRE)
        assert math.remainder(one.heading + other.heading, math.tau) == pytest.approx(0, abs=1e-4)


def test_time_reversed_the_path_is_the_same():
    """Driving the same fixes backwards in time is the same drive in reverse, but for its first fixes."""
    truth = straight(duration=40)
    z = measured(truth)
    back = [replace(each, t=z[-1].t - each.t) for each in reversed(z)]
    ahead = smooth(z)[20:-20]
    again = list(reversed(smooth(back)))[20:-20]
    assert (
        rms(math.hypot(a.east - b.east, a.north - b.north) for a, b in zip(ahead, again, strict=True)) < 2 * CENTIMETRE
    )


def test_outliers_are_left_out():
    truth = straight(duration=40)
    z = measured(truth)
    random = np.random.default_rng(2)
    for k in random.choice(len(z), 5, replace=False).tolist():
        z[k] = replace(z[k], east=z[k].east + random.uniform(1, 5), north=z[k].north - random.uniform(1, 5))
    assert max(position_error(*pair) for pair in pairs(smooth(z), truth)) < 10 * CENTIMETRE


def test_a_start_in_reverse_is_seen_from_the_whole():
    truth = drive(lambda t: -1.0 if t < 6 else (0.0 if t < 8 else 1.5), lambda _: 0.0, 40)
    poses = smooth(measured(truth))
    assert poses[10].speed < -0.5
    assert poses[-1].speed > 1.0
    assert all(heading_error(*pair) < 15 * DEGREE for pair in pairs(poses, truth)[10:-10])


def test_gaps_cut_the_recording_and_short_ones_are_bridged():
    truth = straight(duration=60)
    holed = [moment for moment in truth if not (20 < moment.t < 26)]
    far = [replace(moment, t=moment.t + 1000) for moment in holed if moment.t > 40]
    moments = [moment for moment in holed if moment.t <= 40] + far
    poses = smooth(measured(moments))
    assert len(poses) == len(moments)
    assert rms(position_error(*pair) for pair in pairs(poses, moments)) < 5 * CENTIMETRE


def test_a_repeated_epoch_is_left_out():
    z = measured(straight(duration=20))
    assert smooth([again for each in z for again in (each, each)]) == smooth(z)


def test_standing_all_the_time_there_is_no_heading():
    poses = smooth(measured(straight(duration=20, speed=0.0)))
    assert len(poses) == 101
    assert not any(pose.heading_known for pose in poses)
    assert all(pose.standing for pose in poses[10:])


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_very_short_recordings_give_what_there_is(count: int):
    assert len(smooth(measured(straight())[:count])) == count


def test_a_long_recording_is_the_same_in_pieces(monkeypatch: pytest.MonkeyPatch):
    """Pieces overlap so that the seam cannot be seen."""
    truth = straight(duration=200)
    z = measured(truth, Kit(velocity=True))
    whole = smooth(z)
    monkeypatch.setattr("guidance_app.estimation.smoothing.PIECE", 400)
    pieces = smooth(z)
    assert [pose.t for pose in pieces] == [pose.t for pose in whole]
    apart = [math.hypot(a.east - b.east, a.north - b.north) for a, b in zip(whole, pieces, strict=True)]
    assert max(apart) < 2 * CENTIMETRE


@pytest.mark.parametrize("seed", range(3))
def test_no_finite_recording_breaks_it(seed: int):
    random = np.random.default_rng(seed)
    t = np.cumsum(random.choice([0.0, 0.1, 0.2, 3.0, 50.0], 200))
    z = [
        Measurement(
            t=float(at),
            arrival=float(at),
            east=float(random.normal(0, 10 ** random.uniform(-3, 3))),
            north=float(random.normal(0, 10 ** random.uniform(-3, 3))),
            quality=FixQuality(int(random.integers(9))),
            cell=None if random.random() < 0.3 else (0.14, 0.18),
            speed=None if random.random() < 0.3 else float(random.uniform(0, 20)),
            course=None if random.random() < 0.3 else float(random.uniform(0, 6)),
        )
        for at in t
    ]
    for pose in smooth(z):
        for field in fields(pose):
            value = getattr(pose, field.name)
            assert not isinstance(value, float) or math.isfinite(value), field.name
        assert pose.covariance is not None
        assert min(pose.covariance[0], pose.covariance[2]) > 0


@pytest.mark.parametrize("kit", ["position", "velocity", "velocity and gyro"])
def test_the_95_percent_ellipse_holds_the_truth(kit: str):
    inside = []
    for seed, heading in enumerate((0.4, 1.3, 2.2, 3.9, 5.3)):
        truth = drive(lambda _: 1.5, lambda t: 0.15 if 15 < t < 30 else 0.0, 45, heading=heading)
        for pose, moment in pairs(smooth(measured(truth, KITS[kit], seed)), truth):
            assert pose.covariance is not None
            east, cross, north = pose.covariance
            de, dn = pose.east - moment.east, pose.north - moment.north
            inside.append((north * de * de - 2 * cross * de * dn + east * dn * dn) / (east * north - cross**2) < 5.991)
    assert np.mean(inside) > 0.9
