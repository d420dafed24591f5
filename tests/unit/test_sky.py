"""The satellites in view: rounds of sentences, systems, signals, and what is lost on the way."""

import math

import pytest
from support.nmea import sentence

from guidance_app.decode.decoder import Decoder
from guidance_app.decode.nmea import read_line
from guidance_app.model import Chunk, Satellite

DIGIT = 1e-9


def sky_of(*bodies: str, arrival: float = 0.0, decoder: Decoder | None = None) -> dict[tuple[str, int], Satellite]:
    decoder = decoder or Decoder()
    for body in bodies:
        decoder.feed(Chunk(arrival, sentence(body)))
    return {(one.system, one.number): one for one in decoder.sky}


def test_a_round_gives_elevation_azimuth_and_signal_and_none_for_what_is_not_tracked() -> None:
    sky = sky_of("GPGSV,2,1,05,02,25,181,42,06,45,146,45,12,19,292,,13,17,209,43", "GPGSV,2,2,05,24,,,30")
    assert len(sky) == 5
    two = sky["GP", 2]
    assert (two.elevation, two.azimuth) == pytest.approx((math.radians(25), math.radians(181)), abs=DIGIT)
    assert two.signal == 42.0
    assert sky["GP", 12].signal is None
    assert (sky["GP", 24].elevation, sky["GP", 24].azimuth, sky["GP", 24].signal) == (None, None, 30.0)


def test_the_signal_at_the_end_is_not_a_satellite_and_the_strongest_signal_counts() -> None:
    sky = sky_of("GPGSV,1,1,01,02,25,181,38,1", "GPGSV,1,1,01,02,25,181,44,8", "GAGSV,1,1,02,02,60,010,41,31,05,100,,7")
    assert set(sky) == {("GP", 2), ("GA", 2), ("GA", 31)}
    assert sky["GP", 2].signal == 44.0


def test_nothing_shows_before_a_round_is_whole_and_a_lost_sentence_leaves_the_last_round() -> None:
    decoder = Decoder()
    assert not sky_of("GPGSV,2,1,05,02,25,181,42,06,45,146,45,12,19,292,,13,17,209,43", decoder=decoder)
    assert len(sky_of("GPGSV,2,2,05,24,,,30", decoder=decoder)) == 5
    assert len(sky_of("GPGSV,2,2,05,24,,,30", decoder=decoder)) == 5
    assert set(sky_of("GPGSV,1,1,00", decoder=decoder)) == set()


def test_a_system_that_is_told_no_more_is_forgotten() -> None:
    decoder = Decoder()
    sky_of("GLGSV,1,1,01,65,25,181,38", decoder=decoder)
    assert len(sky_of("GPGSV,1,1,01,02,25,181,38", arrival=20.0, decoder=decoder)) == 2
    assert set(sky_of("GPGSV,1,1,01,02,25,181,38", arrival=31.0, decoder=decoder)) == {("GP", 2)}


def test_a_copy_goes_its_own_way() -> None:
    decoder = Decoder()
    sky_of("GLGSV,1,1,01,65,25,181,38", decoder=decoder)
    other = decoder.fork()
    assert sky_of("GPGSV,1,1,01,02,25,181,38", decoder=other).keys() == {("GL", 65), ("GP", 2)}
    assert [one.system for one in decoder.sky] == ["GL"]


def test_an_empty_count_says_nothing() -> None:
    assert read_line(sentence("GPGSV,,,").decode().strip()).in_view is None
