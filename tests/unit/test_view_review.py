"""What a review shows: every stroke has a colour of the legend, jumps are not joined, and the small map is whole."""

from dataclasses import replace

import numpy as np
import pytest
from support.drive_logs import passes_driven

from guidance_app.language import ENGLISH
from guidance_app.model import NO_PASS, DriveLog
from guidance_app.view.review import ColourBy, coloured_track, error_along, thumbnail_svg


@pytest.mark.parametrize("by", list(ColourBy))
def test_every_stroke_has_a_colour_of_the_legend(by: ColourBy) -> None:
    made = coloured_track(passes_driven(0.02, -0.15, 0.5), by, ENGLISH)
    known = {one.colour for one in made.legend}
    assert {tuple(int(part) for part in colour) for colour in made.colours} <= known
    assert len(made.strokes) == len(made.colours) > 1000
    assert all(one.words for one in made.legend)


def test_the_worse_error_has_the_warmer_colour() -> None:
    made = coloured_track(passes_driven(0.02, 0.5), ColourBy.ERROR, ENGLISH)
    assert tuple(made.colours[10]) == made.legend[0].colour
    assert tuple(made.colours[-10]) == made.legend[-2].colour


def test_off_the_pass_is_grey_and_a_jump_is_not_joined() -> None:
    log = passes_driven(0.0, 0.0)
    away = replace(log, pass_number=np.full(len(log), NO_PASS, np.int32))
    made = coloured_track(away, ColourBy.ERROR, ENGLISH)
    assert {tuple(one) for one in made.colours.tolist()} == {made.legend[-1].colour}
    lengths = np.hypot(*(made.strokes[:, 1] - made.strokes[:, 0]).T)
    assert lengths.max() < 25.0


@pytest.mark.parametrize("by", list(ColourBy))
def test_a_drive_without_a_fix_has_an_empty_map(by: ColourBy) -> None:
    nothing = passes_driven(0.0).part(slice(0, 0))
    assert len(coloured_track(nothing, by, ENGLISH).strokes) == 0
    assert error_along(nothing, None)[0].size == 0
    assert thumbnail_svg(nothing).startswith("<svg")


def test_the_error_along_a_pass_is_in_centimetres_over_metres() -> None:
    along, error = error_along(passes_driven(0.1, -0.2), 1)
    assert error == pytest.approx(np.full(len(error), -20.0))
    assert along[-1] == pytest.approx(200.0, abs=1.0)
    both, _ = error_along(passes_driven(0.1, -0.2), None)
    assert both[-1] == pytest.approx(400.0, abs=2.0)


def test_the_small_map_stays_inside_its_square() -> None:
    log: DriveLog = passes_driven(0.0, 0.0)
    ring = np.array([[-10.0, -10.0], [20.0, -10.0], [20.0, 210.0], [-10.0, 210.0]])
    svg = thumbnail_svg(log, (ring,), 96)
    numbers = [float(part) for part in svg.split('d="')[1].split('"')[0].strip("MZ").replace("L", " ").split()]
    assert 0 <= min(numbers) <= max(numbers) <= 96
