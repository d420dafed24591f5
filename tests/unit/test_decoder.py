import math
from collections import Counter

import pytest
from support.nmea import (
    epoch,
    fixes_of,
    gga,
    gst,
    hdt,
    metres_apart,
    observations_of,
    rejections_of,
    rmc,
    sentence,
    vtg,
)

from guidance_app.decode.decoder import Decoder
from guidance_app.model import Attitude, Chunk, FixQuality, NoFix, Observation

MILLIMETRE = 1e-3
NOON = 43200.0
DAY = 86400.0


def _at_once(data: bytes) -> list[Observation]:
    return observations_of([Chunk(0.0, data)])


def _attitudes(observations: list[Observation]) -> list[Attitude]:
    return [one for one in observations if isinstance(one, Attitude)]


# --- what makes a fix ------------------------------------------------------------------------------------------------


def test_a_fix_joins_what_its_epoch_said() -> None:
    data = gga(NOON, 10.0, 20.0) + rmc(NOON, 10.0, 20.0, knots="3.6", course="45.0") + gst(NOON) + hdt(40.0)
    (fix,) = fixes_of(_at_once(data))
    assert fix.t == NOON
    assert fix.quality is FixQuality.RTK_FIXED
    assert (fix.satellites, fix.hdop, fix.correction_age) == (12, 0.8, 1.0)
    assert fix.height == pytest.approx(95.0)
    assert fix.sigma == (0.02, 0.03)
    assert fix.speed == pytest.approx(3.6 * 1852 / 3600)
    assert fix.course == pytest.approx(math.radians(45.0))
    assert fix.heading == pytest.approx(math.radians(40.0))
    assert fix.utc == pytest.approx(1577923200.0 + NOON)
    assert fix.cell == pytest.approx((1852e-7, 1852e-7 * math.cos(math.radians(52.0))), rel=1e-4)


@pytest.mark.parametrize(
    ("data", "quality"),
    [
        (rmc(NOON), FixQuality.AUTONOMOUS),
        (rmc(NOON, tail=",,,R"), FixQuality.RTK_FIXED),
        (rmc(NOON, tail=",,,D,V"), FixQuality.DGPS),
        (rmc(NOON, tail=",,"), FixQuality.AUTONOMOUS),
        (sentence("GPGLL,5200.0,N,00800.0,E,120000,A,D"), FixQuality.DGPS),
        (sentence("GNGNS,120000,5200.0,N,00800.0,E,NF,9,1.0,50.0,45.0,,"), FixQuality.RTK_FLOAT),
        (sentence("PAOGI,120000,5200.0,N,00800.0,E,4,12,0.7,50.0,1,5.0,90.0,0.0,0.0,0.0"), FixQuality.RTK_FIXED),
        (sentence("KSXT,20200102120000.00,8.0,52.0,95.0,,,90.0,3.6,,2,0,0,12"), FixQuality.RTK_FLOAT),
    ],
)
def test_one_kind_of_sentence_alone_gives_a_fix(data: bytes, quality: FixQuality) -> None:
    (fix,) = fixes_of(_at_once(data))
    assert (fix.t, fix.latitude_deg, fix.longitude_deg) == (NOON, 52.0, 8.0)
    assert fix.quality is quality


@pytest.mark.parametrize(
    "data",
    [
        gga(NOON, quality="0"),
        rmc(NOON, status="V"),
        rmc(NOON, tail=",,,N"),
        gga(NOON, quality="0") + rmc(NOON),
        sentence("GPGGA,120000,,,,,1,,,,M,,M,,"),
        sentence("GNGNS,120000,5200.0,N,00800.0,E,NN,0,,,,,"),
        sentence("GPGGA,,,,,,0,,,,M,,M,,"),
    ],
)
def test_no_fix_is_said_and_is_not_zero_zero(data: bytes) -> None:
    (observation,) = _at_once(data)
    assert isinstance(observation, NoFix)


def test_a_gga_with_an_empty_quality_needs_an_rmc_that_vouches() -> None:
    assert rejections_of(_at_once(gga(NOON, quality=""))) == ["fix quality missing"]
    (fix,) = fixes_of(_at_once(gga(NOON, quality="") + rmc(NOON)))
    assert fix.quality is FixQuality.AUTONOMOUS


def test_a_position_without_any_time_is_not_believed() -> None:
    assert rejections_of(_at_once(sentence("GPGLL,5200.0,N,00800.0,E"))) == ["position without time"]


def test_what_is_not_said_is_none() -> None:
    (fix,) = fixes_of(_at_once(sentence("GPGGA,120000,5200.0,N,00800.0,E,1,,,,M,,M,,")))
    absent = (
        "utc",
        "altitude",
        "geoid_separation",
        "height",
        "satellites",
        "hdop",
        "sigma",
        "speed",
        "course",
        "heading",
    )
    assert [getattr(fix, name) for name in absent] == [None] * len(absent)


def test_an_empty_course_at_standstill_is_none_and_not_north() -> None:
    (fix,) = fixes_of(_at_once(gga(NOON) + rmc(NOON, knots="0.00", course="") + vtg("", "0.00")))
    assert (fix.speed, fix.course) == (0.0, None)


def test_speed_comes_from_vtg_where_rmc_has_none() -> None:
    (fix,) = fixes_of(_at_once(gga(NOON) + rmc(NOON, status="V", knots="9.0") + vtg("45.0", "1.0")))
    assert fix.speed == pytest.approx(1852 / 3600)


def test_two_gga_of_one_epoch_are_two_antennas() -> None:
    data = b"".join(gga(NOON + k, k, 0.0) + gga(NOON + k, k, 1.0) + rmc(NOON + k, k) for k in range(5))
    fixes = fixes_of(_at_once(data))
    assert len(fixes) == 5
    for fix in fixes:
        assert fix.second_antenna_deg is not None
        assert fix.second_antenna_deg[0] == pytest.approx(fix.latitude_deg)
        assert fix.second_antenna_deg[1] > fix.longitude_deg


def test_a_gga_said_twice_is_no_second_antenna() -> None:
    (fix,) = fixes_of(_at_once(gga(NOON) + gga(NOON)))
    assert fix.second_antenna_deg is None


def test_a_coarse_rmc_does_not_stand_in_for_one_lost_gga_but_for_a_lost_receiver() -> None:
    data = b"".join(
        (gga(NOON + k, k) if k not in (3, *range(5, 20)) else b"") + rmc(NOON + k, k, decimals=3) for k in range(20)
    )
    observations = _at_once(data)
    fixes = fixes_of(observations)
    assert [fix.t - NOON for fix in fixes if fix.cell and fix.cell[0] < MILLIMETRE] == [0, 1, 2, 4]
    assert [fix.t - NOON for fix in fixes if fix.cell and fix.cell[0] > 1.0] == list(range(10, 20))
    assert Counter(rejections_of(observations)) == {"finer position missing": 6}


def test_a_magnetic_heading_waits_for_the_declination() -> None:
    hdm = sentence("HCHDM,358.0,M")
    first, second = fixes_of(_at_once(gga(NOON) + hdm + gga(NOON + 1) + hdm + rmc(NOON + 1, tail=",3.0,E,A")))
    assert first.heading is None
    assert second.heading == pytest.approx(math.radians(1.0))


def test_an_imu_heading_with_an_arbitrary_zero_is_no_heading() -> None:
    (fix,) = fixes_of(_at_once(sentence("PANDA,120000,5200.0,N,00800.0,E,4,12,0.7,50.0,1,5.0,2217,31,-12,5")))
    assert fix.heading is None
    assert fix.roll == pytest.approx(math.radians(3.1))


# --- when an epoch closes --------------------------------------------------------------------------------------------


def test_an_epoch_closes_at_its_last_sentence_once_the_stream_is_known() -> None:
    decoder = Decoder()
    for k in range(3):
        decoder.feed(Chunk(float(k), gga(NOON + k, k) + rmc(NOON + k, k)))
    assert decoder.feed(Chunk(3.0, gga(NOON + 3, 3))) == ()
    (fix,) = fixes_of(decoder.feed(Chunk(3.01, rmc(NOON + 3, 3))))
    assert (fix.t, fix.arrival) == (NOON + 3, 3.0)
    assert decoder.wake_at is None


def test_an_epoch_closes_when_the_next_time_appears() -> None:
    decoder = Decoder()
    assert decoder.feed(Chunk(0.0, gga(NOON))) == ()
    (fix,) = decoder.feed(Chunk(0.0, gga(NOON + 1)))
    assert fixes_of([fix])[0].t == NOON


def test_an_epoch_closes_after_silence_that_an_empty_chunk_tells() -> None:
    decoder = Decoder()
    decoder.feed(Chunk(5.0, gga(NOON)))
    assert decoder.wake_at == pytest.approx(5.3)
    assert decoder.feed(Chunk(5.29, b"")) == ()
    (fix,) = fixes_of(decoder.feed(Chunk(5.3, b"")))
    assert (fix.t, fix.arrival) == (NOON, 5.0)
    assert decoder.wake_at is None


def test_silence_is_measured_in_the_epoch_interval() -> None:
    decoder = Decoder()
    for k in range(10):
        decoder.feed(Chunk(k / 10, gga(NOON + k / 10)))
    decoder.feed(Chunk(1.0, gga(NOON + 1.0) + gst(NOON + 1.0)))
    assert decoder.interval == pytest.approx(0.1)
    decoder.feed(Chunk(1.1, gga(NOON + 1.1)))
    decoder.feed(Chunk(1.13, b""))
    assert decoder.wake_at is None


def test_a_sentence_that_comes_too_late_is_awaited_next_time() -> None:
    decoder = Decoder()
    found = []
    for k in range(12):
        found += decoder.feed(Chunk(float(k), gga(NOON + k)))
        if k >= 6:
            found += decoder.feed(Chunk(k + 0.05, rmc(NOON + k)))
    speeds = {fix.t - NOON: fix.speed for fix in fixes_of(found)}
    assert speeds[5] is None
    assert speeds[10] is not None
    assert len(fixes_of(found)) == 12


def test_a_slow_sentence_does_not_hold_up_the_epochs_between() -> None:
    decoder = Decoder()
    closed_at_once = []
    for k in range(60):
        t = NOON + k / 10
        data = gga(t) + (rmc(t) if k % 10 == 0 else b"")
        closed_at_once.append(bool(fixes_of(decoder.feed(Chunk(k / 10, data)))) and decoder.wake_at is None)
    assert all(closed_at_once[30:])


def test_a_slow_line_full_of_satellites_does_not_part_an_epoch() -> None:
    """4800 baud: between GGA and RMC half a second of GSV goes by, longer than the silence that closes an epoch."""
    satellites = sentence("GPGSV,3,1,10,02,25,181,42,06,45,146,45,12,19,292,47,13,17,209,43,1") * 4
    decoder, found = Decoder(), []
    for k in range(10):
        arrival = float(k)
        for line in (gga(NOON + k) + satellites + rmc(NOON + k)).splitlines(keepends=True):
            arrival += len(line) / 480.0
            found += decoder.feed(Chunk(arrival - 0.01, b""))
            found += decoder.feed(Chunk(arrival, line))
    fixes = fixes_of(found)
    assert len(fixes) == 10
    assert all(fix.speed is not None for fix in fixes)


def test_a_lost_sentence_costs_one_silence_and_not_the_rhythm() -> None:
    decoder = Decoder()
    found: list[Observation] = []
    for k in range(10):
        found += decoder.feed(Chunk(float(k), gga(NOON + k) + (rmc(NOON + k) if k != 5 else b"")))
    speeds = [fix.speed for fix in fixes_of([*found, *decoder.finish(10.0)])]
    assert [k for k, speed in enumerate(speeds) if speed is None] == [5]


# --- attitude --------------------------------------------------------------------------------------------------------


def test_a_heading_at_the_fixes_rate_is_part_of_the_fix() -> None:
    observations = _at_once(b"".join(gga(NOON + k, k) + hdt(10.0 + k) for k in range(6)))
    assert [round(math.degrees(fix.heading or 0.0)) for fix in fixes_of(observations)] == [10, 11, 12, 13, 14, 15]
    assert _attitudes(observations) == []


def test_a_heading_faster_than_the_fixes_is_an_attitude_of_its_own() -> None:
    observations = []
    decoder = Decoder()
    for k in range(50):
        data = (gga(NOON + k / 5) if k % 5 == 0 else b"") + hdt(float(k))
        observations += decoder.feed(Chunk(k / 5, data))
    late = [one for one in observations if one.arrival >= 4.0]
    assert [fix.heading for fix in fixes_of(late)] == [None] * 6
    assert [round(math.degrees(one.heading or 0.0)) for one in _attitudes(late)] == list(range(20, 50))


def test_a_reading_with_its_own_time_is_an_attitude_with_that_time() -> None:
    line = sentence("PASHR,120000.04,010.51,T,+00.39,-00.79,-00.84,0.151,0.075,0.555,1,0")
    (attitude,) = _attitudes(_at_once(gga(NOON) + line))
    assert attitude.t == pytest.approx(NOON + 0.04)
    assert attitude.roll == pytest.approx(math.radians(0.39))
    assert attitude.link == "receiver"


def test_a_reading_just_before_its_epoch_is_lent_to_the_fix() -> None:
    decoder = Decoder("left")
    first = decoder.feed(Chunk(0.9, hdt(33.0)))
    (attitude,) = _attitudes(list(first))
    assert (attitude.arrival, attitude.link) == (0.9, "left")
    decoder.feed(Chunk(1.0, gga(NOON)))
    (fix,) = fixes_of(decoder.finish(1.0))
    assert fix.heading == pytest.approx(math.radians(33.0))


def test_a_reading_of_an_epoch_without_a_fix_is_told_all_the_same() -> None:
    observations = _at_once(gga(NOON, quality="0") + hdt(33.0) + gga(NOON + 1, quality="0"))
    assert [type(one) for one in observations] == [NoFix, Attitude, NoFix]


def test_a_reading_long_before_an_epoch_is_not_lent() -> None:
    decoder = Decoder()
    decoder.feed(Chunk(0.5, hdt(33.0)))
    decoder.feed(Chunk(1.0, gga(NOON)))
    assert fixes_of(decoder.finish(1.0))[0].heading is None


def test_what_a_seapath_calls_invalid_is_not_used() -> None:
    good, bad = sentence("PSXN,20,0,0,0,0"), sentence("PSXN,20,0,0,2,2")
    attitude = sentence("PSXN,23,0.58,-1.09,218.83,0.78")
    assert len(_attitudes(_at_once(good + attitude))) == 1
    assert _attitudes(_at_once(bad + attitude)) == []


def test_an_attitude_that_says_nothing_is_none() -> None:
    assert _at_once(sentence("GPHDT,,T") + sentence("GPTHS,,V")) == []


# --- time ------------------------------------------------------------------------------------------------------------


def test_time_runs_on_over_midnight() -> None:
    data = b"".join(
        rmc(DAY - 5 + k, 5.0 * k, date="310120" if k < 5 else "010220") + gga(DAY - 5 + k, 5.0 * k) for k in range(10)
    )
    fixes = fixes_of(_at_once(data))
    assert [fix.t for fix in fixes] == [DAY - 5 + k for k in range(10)]
    assert [round((fix.utc or 0.0) - (fixes[0].utc or 0.0)) for fix in fixes] == list(range(10))


def test_time_runs_on_when_only_the_time_of_day_is_known() -> None:
    fixes = fixes_of(_at_once(b"".join(gga((DAY - 2 + k) % DAY, float(k)) for k in range(5))))
    assert [fix.t for fix in fixes] == [DAY - 2 + k for k in range(5)]
    assert {fix.utc for fix in fixes} == {None}


def test_a_nights_pause_goes_ahead_and_not_back() -> None:
    hours = 3600.0
    evening = b"".join(gga(18 * hours + k, float(k)) for k in range(3))
    morning = b"".join(gga(8 * hours + k, float(k)) for k in range(6))
    fixes = fixes_of(_at_once(evening + morning))
    assert [fix.t for fix in fixes] == sorted(fix.t for fix in fixes)
    assert fixes[-1].t == DAY + 8 * hours + 5


def test_a_week_rollover_changes_the_date_and_not_the_time() -> None:
    dates = ["060419"] * 5 + ["220899"] * 5
    fixes = fixes_of(_at_once(b"".join(epoch_on(NOON + k, k, dates[k]) for k in range(10))))
    assert [fix.t for fix in fixes] == [NOON + k for k in range(10)]
    assert fixes[4].utc == pytest.approx(1554508800.0 + NOON + 4)
    assert fixes[9].utc == pytest.approx(935280000.0 + NOON + 9)


def test_one_wrong_date_is_not_believed() -> None:
    dates = ["020120"] * 4 + ["020130"] + ["020120"] * 3
    fixes = fixes_of(_at_once(b"".join(epoch_on(NOON + k, k, dates[k]) for k in range(8))))
    assert [round((fix.utc or 0.0) - 1577923200.0 - NOON) for fix in fixes] == list(range(8))


def test_a_leap_second_is_a_second() -> None:
    data = b"".join(
        sentence(f"GPGGA,{text},5200.0,N,00800.0,E,1,08,0.9,50.0,M,45.0,M,,")
        for text in ("235959.0", "235960.0", "235960.5", "000001.0")
    )
    assert [fix.t for fix in fixes_of(_at_once(data))] == [DAY - 1, DAY, DAY + 0.5, DAY + 1]


def test_a_time_without_decimals_is_a_time() -> None:
    (fix,) = fixes_of(_at_once(sentence("GPGGA,120001,5200.0,N,00800.0,E,1,08,0.9,50.0,M,45.0,M,,")))
    assert fix.t == NOON + 1


def epoch_on(seconds: float, north: float, date: str) -> bytes:
    return gga(seconds, north) + rmc(seconds, north, date=date)


# --- what is not believed --------------------------------------------------------------------------------------------


def test_a_wrong_sentence_with_a_right_checksum_does_not_move_the_tractor() -> None:
    data = b"".join(gga(NOON + k / 10, k / 10, 900.0 if k == 10 else 0.0) for k in range(20))
    observations = _at_once(data)
    assert rejections_of(observations) == ["implausible jump"]
    assert len(fixes_of(observations)) == 19
    assert max(metres_apart(fix, fixes_of(observations)[0]) for fix in fixes_of(observations)) < 2.0


def test_without_a_reported_speed_the_fixes_themselves_tell_what_is_a_jump() -> None:
    observations = _at_once(b"".join(gga(NOON + k, float(k), 40.0 if k == 5 else 0.0) for k in range(8)))
    assert rejections_of(observations) == ["implausible jump"]


def test_a_true_jump_is_believed_at_the_third_fix_that_agrees() -> None:
    data = b"".join(gga(NOON + k / 10, k / 10, 0.0 if k < 10 else 900.0) for k in range(20))
    observations = _at_once(data)
    assert rejections_of(observations) == ["implausible jump"] * 2
    assert [round((fix.t - NOON) * 10) for fix in fixes_of(observations)] == [*range(10), *range(12, 20)]


def test_glitches_that_do_not_agree_are_never_believed() -> None:
    places = [0.0, 0.0, 0.0, 900.0, -900.0, 1800.0, -1800.0, 2700.0, 0.0, 0.0]
    observations = _at_once(b"".join(gga(NOON + k / 10, 0.0, east) for k, east in enumerate(places)))
    assert all(metres_apart(fix, fixes_of(observations)[0]) < MILLIMETRE for fix in fixes_of(observations))
    assert len(rejections_of(observations)) == 5


def test_a_wrong_time_with_a_right_checksum_is_not_believed() -> None:
    times = [NOON, NOON + 1, NOON + 2, NOON + 7200, NOON + 4, NOON + 5]
    observations = _at_once(b"".join(gga(t) for t in times))
    assert [fix.t for fix in fixes_of(observations)] == [NOON, NOON + 1, NOON + 2, NOON + 4, NOON + 5]


def test_a_clock_that_is_set_back_is_believed_in_the_end() -> None:
    times = [*(NOON + k for k in range(5)), *(NOON - 18 + k for k in range(8))]
    fixes = fixes_of(_at_once(b"".join(gga(t) for t in times)))
    assert fixes[-1].t == NOON - 18 + 7


def test_a_speed_that_jumps_costs_the_speed_and_not_the_fix() -> None:
    data = b"".join(gga(NOON + k) + rmc(NOON + k, knots="95.0" if k == 5 else "5.0") for k in range(8))
    observations = _at_once(data)
    fixes = fixes_of(observations)
    assert [fix.speed is None for fix in fixes] == [False] * 5 + [True] + [False] * 2
    assert fixes[5].course is None
    assert rejections_of(observations) == ["implausible speed"]


def test_a_fast_start_is_believed() -> None:
    east = [0.0, 5.0, 15.0, 30.0, 50.0, 75.0, 105.0]
    assert rejections_of(_at_once(b"".join(gga(NOON + k, 0.0, metres) for k, metres in enumerate(east)))) == []


def test_a_stream_without_checksums_is_read_and_counted() -> None:
    decoder = Decoder()
    bare = b"".join(gga(NOON + k).partition(b"*")[0] + b"\r\n" for k in range(4))
    assert len(fixes_of([*decoder.feed(Chunk(0.0, bare)), *decoder.finish(0.0)])) == 4
    assert (decoder.sentences, decoder.unchecked, sum(decoder.rejected.values())) == (4, 4, 0)


def test_in_a_stream_with_checksums_a_sentence_without_one_is_refused() -> None:
    observations = _at_once(gga(NOON) + gga(NOON + 1).partition(b"*")[0] + b"\r\n" + gga(NOON + 2))
    assert [fix.t for fix in fixes_of(observations)] == [NOON, NOON + 2]
    assert rejections_of(observations) == ["checksum missing"]


def test_every_sentence_is_decoded_or_counted_with_its_reason() -> None:
    decoder = Decoder()
    decoder.feed(Chunk(0.0, epoch(NOON) + b"$GPGGA,1*00\r\n$GPXYZ,1*44\r\n" + sentence("GPTXT,hello") + b"$junk\r\n"))
    assert decoder.sentences == sum(decoder.kinds.values()) + sum(decoder.rejected.values())
    assert decoder.kinds == {"GGA": 1, "RMC": 1}
    assert decoder.rejected["checksum wrong"] == 2
    assert decoder.rejected["unknown sentence"] == 1


# --- copies ----------------------------------------------------------------------------------------------------------


def test_a_copy_goes_on_as_the_original_and_neither_touches_the_other() -> None:
    data = [epoch(NOON + k, k) + hdt(float(k)) for k in range(20)]
    whole = observations_of([Chunk(float(k), one) for k, one in enumerate(data)])
    decoder = Decoder()
    before = [
        one for k in range(7) for one in decoder.feed(Chunk(float(k), data[k] + b"$GPGG"[: 0 if k < 6 else None]))
    ]
    copy = decoder.fork()
    decoder.feed(Chunk(6.5, b"A,broken*00\r\n" + gga(NOON + 6.5, 900.0) + b"$GPGLL,"))
    after = list(copy.feed(Chunk(7.0, b"\r\n" + data[7])))
    after += [one for k in range(8, 20) for one in copy.feed(Chunk(float(k), data[k]))]
    after += copy.finish(19.0)
    assert fixes_of([*before, *after]) == fixes_of(whole)
    assert copy.rejected == {"checksum missing": 1}
    assert decoder.rejected["checksum wrong"] == 1
