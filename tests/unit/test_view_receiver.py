"""The receiver's page in words and figures, and what is said of the links beside it."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.snapshots import field_snapshot

from guidance_app.console.sky import sky_svg
from guidance_app.language import ENGLISH
from guidance_app.model import ATTITUDE, CORRECTIONS, LinkState, LinkStatus, Satellite, Snapshot
from guidance_app.view.links import beside_notices
from guidance_app.view.receiver import grid_words, raw_text, receiver_view, sent_words, sky_dots, sky_words

EMPTY = Snapshot(0, 0.0, LinkState())
HAIR = 1e-9


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        (
            (0.1852, 0.1400),
            "This receiver rounds to 19 cm × 14 cm: the adaptive filter is worth it.",
        ),
        ((0.0188, 0.014), "This receiver rounds to 1.9 cm × 1.4 cm: fine enough to steer by, and the filter calms it."),
        ((0.000185, 0.00014), "This receiver rounds to 0.18 mm × 0.14 mm: its rounding does not matter."),
        ((1.85, 1.4), "This receiver rounds to 1.9 m × 1.4 m: the adaptive filter is worth it."),
    ],
)
def test_the_grid_is_said_with_what_it_means(cell: tuple[float, float], words: str) -> None:
    assert grid_words(cell, ENGLISH) == words


def test_the_page_says_everything_of_a_drive() -> None:
    snapshot = field_snapshot(100.0)
    view = receiver_view(snapshot, 1234.0, 100.2, ENGLISH)
    rows = dict(view.rows)
    assert view.link_level == "good"
    assert rows["Fix"] == "RTK fixed · <1 s old"
    assert rows["Rate"] == "10 Hz"
    assert (rows["Satellites used"], rows["HDOP"]) == ("17", "0.7")
    assert rows["Data"].startswith("1.2 kB/s")
    assert "This receiver rounds to" in view.grid
    assert "GSV" in view.sky_words


def test_before_anything_has_come_there_are_dashes() -> None:
    view = receiver_view(EMPTY, 0.0, 3.0, ENGLISH)
    assert dict(view.rows)["Fix"] == "–"
    assert (view.grid, view.sky) == ("", ())


def test_sensor_and_caster_have_rows_of_their_own() -> None:
    beside = {
        ATTITUDE: LinkState(LinkStatus.ATTITUDE, last_data=99.9),
        CORRECTIONS: LinkState(LinkStatus.CORRECTED, what="caster.example MOUNT"),
    }
    rows = dict(receiver_view(replace(field_snapshot(100.0), links_beside=beside), 0.0, 100.0, ENGLISH).rows)
    assert rows["Attitude sensor"] == "gives roll and heading"
    assert rows["Caster"] == "caster.example MOUNT"
    beside[CORRECTIONS] = LinkState(LinkStatus.DOWN, reason="the caster is gone")
    rows = dict(receiver_view(replace(field_snapshot(100.0), links_beside=beside), 0.0, 100.0, ENGLISH).rows)
    assert rows["Caster"] == "the caster is gone"


@given(
    st.lists(
        st.builds(
            Satellite,
            st.sampled_from(["GP", "GL", "GA", "XX"]),
            st.integers(1, 99),
            st.none() | st.floats(-0.5, math.pi / 2),
            st.none() | st.floats(0, math.tau),
            st.none() | st.floats(0, 99),
        )
    )
)
def test_every_satellite_lies_in_the_circle(satellites: list[Satellite]) -> None:
    dots = sky_dots(satellites)
    assert all(math.hypot(dot.x, dot.y) <= 1.0 + HAIR for dot in dots)
    assert len(dots) <= len(satellites)
    assert sky_svg(dots).count("<g class") == len(dots)


def test_north_is_up_east_is_right_the_zenith_in_the_middle() -> None:
    def dot_at(elevation_deg: float, azimuth_deg: float) -> tuple[float, float]:
        one = Satellite("GP", 1, math.radians(elevation_deg), math.radians(azimuth_deg), 45.0)
        return sky_dots([one])[0].x, sky_dots([one])[0].y

    assert dot_at(90, 123) == pytest.approx((0, 0), abs=HAIR)
    assert dot_at(0, 0) == pytest.approx((0, -1), abs=HAIR)
    assert dot_at(45, 90) == pytest.approx((0.5, 0), abs=HAIR)


def test_signal_and_system_are_in_the_dot() -> None:
    sky = [
        Satellite("GP", 3, 1.0, 1.0, 45.0),
        Satellite("GP", 33, 1.0, 2.0, 35.0),
        Satellite("GL", 70, 1.0, 3.0, 20.0),
        Satellite("GA", 5, 1.0, 4.0, None),
    ]
    assert {dot.label: dot.level for dot in sky_dots(sky)} == {
        "G03": "good",
        "S120": "fair",
        "R70": "bad",
        "E05": "off",
    }
    assert sky_dots(sky)[0].label == "E05"
    assert sky_words(sky, ENGLISH) == "3 of 4 satellites tracked, the strongest with 45 dB-Hz"
    assert sky_words(sky[3:], ENGLISH) == "1 satellite in view, none tracked"
    assert sky_svg(()) == ""


def test_sentences_that_are_not_used_are_marked_and_the_rare_ones_counted_together() -> None:
    kinds = {"GNGGA": 10, "PUBX": 9, "PSXN": 8, "PANDA": 7, **{f"X{number:03d}": 1 for number in range(20)}}
    rows = dict(sent_words(kinds, ENGLISH))
    assert (rows["GNGGA"], rows["PUBX"], rows["PSXN"], rows["PANDA"]) == ("10", "9 (not used)", "8", "7")
    assert rows["others"] == "10"


def test_raw_lines_are_written_without_control_characters() -> None:
    assert raw_text([b"$GPGGA,1*00", b"\xd3\x00<b>"], 5) == "$GPGGA,1*00\n\\xd3\\x00<b>"
    assert raw_text([b"a", b"b", b"c"], 2) == "b\nc"


@pytest.mark.parametrize(
    ("link", "state", "said"),
    [
        (ATTITUDE, LinkState(LinkStatus.ATTITUDE, last_data=99.8), None),
        (ATTITUDE, LinkState(LinkStatus.ATTITUDE, last_data=98.0), "is silent"),
        (ATTITUDE, LinkState(LinkStatus.DOWN, reason="it is unplugged"), "roll is not corrected: it is unplugged"),
        (ATTITUDE, LinkState(LinkStatus.NO_SENTENCE, reason="the baud rate?"), "roll is not corrected: the baud rate?"),
        (ATTITUDE, LinkState(LinkStatus.NO_DATA, since=98.0), None),
        (ATTITUDE, LinkState(LinkStatus.NO_DATA, since=90.0), "is silent"),
        (ATTITUDE, LinkState(LinkStatus.ENDED), None),
        (CORRECTIONS, LinkState(LinkStatus.CORRECTED), None),
        (CORRECTIONS, LinkState(LinkStatus.DOWN, reason="refused"), "No corrections: refused"),
        ("another", LinkState(LinkStatus.DOWN, reason="refused"), None),
    ],
)
def test_what_is_lost_beside_the_receiver_is_said(link: str, state: LinkState, said: str | None) -> None:
    notices = beside_notices(replace(field_snapshot(100.0), links_beside={link: state}), 100.0, ENGLISH)
    assert (len(notices) == 1 and said in notices[0]) if said else not notices
