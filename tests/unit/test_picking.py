"""What a finger picks from a field: an edge or exclusions, named by places that outlive changes of the field."""

import itertools
import math
import re

import numpy as np
import pytest
import shapely

from guidance_app.documents import FieldDocument, Geometry, Units
from guidance_app.field_editing import without_exclusion
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.picking import edge_words, picking_of, places_in
from guidance_app.guidance.wishes import exclusions_with
from guidance_app.language import words_for
from guidance_app.model import FloatArray
from guidance_app.view.drawing_field import AROUND, PASSABLE, field_picture
from guidance_app.view.units import small_area_text

FRAME = FieldFrame(47.5, 8.5)
CENTIMETRE = 0.01
BOUNDARY = np.array([[0.0, 0.0], [300.0, 0.0], [300.0, 100.2], [150.0, 100.0], [0.0, 100.0], [0.0, 0.0]])


def box(west: float, south: float, side: float) -> FloatArray:
    return np.array(
        [[west, south], [west + side, south], [west + side, south + side], [west, south + side], [west, south]]
    )


def field_of(*holes: FloatArray) -> FieldDocument:
    rings = [[(float(lon), float(lat)) for lon, lat in FRAME.lonlat_from_array(ring)] for ring in (BOUNDARY, *holes)]
    return FieldDocument(name="F", boundary=Geometry(coordinates=[[*ring[:-1], ring[0]] for ring in rings]))


FIELD = field_of(box(40, 40, 4), box(120, 30, 30), box(220, 60, 12))


def test_an_edge_is_the_whole_straight_stretch_whatever_corners_lie_on_it() -> None:
    picking = picking_of(FIELD)
    south, north = picking.polygon.bounds[1], picking.polygon.bounds[3]
    named = {picking.edge_at(east, north - 1.0) for east in (-140.0, -10.0, 10.0, 140.0)}
    assert len(named) == 1
    metres, degrees = edge_words(picking.edge_of(named.pop()))
    assert metres == pytest.approx(300.0, abs=0.1)
    assert degrees == pytest.approx(90.0, abs=0.2)
    assert picking.edge_at(0.0, south + 1.0) != picking.edge_at(0.0, north - 1.0)


def test_an_edge_is_found_again_by_the_place_that_names_it() -> None:
    picking = picking_of(FIELD)
    for edge in picking.edges:
        east, north = edge.mean(axis=0)
        again = picking.edge_of(picking.edge_at(float(east), float(north)))
        assert np.abs(again - edge).max() < CENTIMETRE


def test_the_next_edge_is_never_that_of_a_pole() -> None:
    lengths = [edge_words(picking_of(FIELD).edge_of(place))[0] for place in picking_of(FIELD).longest_edges()]
    assert lengths == sorted(lengths, reverse=True)
    assert len(lengths) == 8  # four of the field, four of the pond
    assert min(lengths) > 25


@pytest.mark.parametrize(("reach", "found"), [(0.0, None), (6.0, 0)])
def test_a_finger_beside_a_small_exclusion_means_it_within_reach(reach: float, found: int | None) -> None:
    picking = picking_of(FIELD)
    ring = picking.rings[1]
    east, north = ring.mean(axis=0)
    assert picking.exclusion_at(float(east) + 7.0, float(north), reach) == found
    assert picking.exclusion_at(float(east), float(north), 0.0) == 0
    assert picking_of(field_of()).exclusion_at(0.0, 0.0, math.inf) is None


def test_places_name_exclusions_and_outlive_that_others_go() -> None:
    places = places_in(FIELD, {1, 2}, [])
    assert exclusions_with(FIELD, places) == {1, 2}
    assert exclusions_with(without_exclusion(FIELD, 1), places) == {0, 1}
    assert exclusions_with(without_exclusion(FIELD, 2), places) == {1}
    assert places_in(FIELD, {1, 2}, places) == places
    own = [(places[0][0] + 1e-6, places[0][1])]
    assert places_in(FIELD, {1, 2}, own) == [own[0], places[1]]
    assert exclusions_with(FIELD, []) == frozenset()


def test_the_picture_tells_the_two_kinds_apart_without_colours() -> None:
    words = words_for("en")
    rings = picking_of(FIELD).rings
    around = field_picture(rings, (), words)
    over = field_picture(rings, {1}, words)
    assert around.count(AROUND) > over.count(AROUND)
    assert PASSABLE not in around
    assert "stroke-dasharray" in over
    assert "stroke-dasharray" not in around
    assert all(f">{number}<" in over for number in (1, 2, 3))


def test_the_numbers_of_many_small_exclusions_stand_apart() -> None:
    poles = [box(100.0 + 9.0 * place, 45.0 + 4.0 * (place % 3), 2.0) for place in range(15)]
    drawn = field_picture(picking_of(field_of(*poles)).rings, {2, 5}, words_for("en"))
    found = re.findall(r'<text x="([\d.]+)" y="([\d.]+)"[^>]*>(\d+)<', drawn)
    assert [int(number) for *_, number in found] == list(range(1, 16))
    places = [(float(x), float(y)) for x, y, _ in found]
    assert min(math.dist(one, other) for one, other in itertools.combinations(places, 2)) > 11.5


@pytest.mark.parametrize(
    ("square_metres", "units", "said"),
    [
        (16.2, Units.METRIC, "16 m²"),
        (999.0, Units.JAPANESE, "999 m²"),
        (100.0, Units.IMPERIAL, "1076 ft²"),
        (12_000.0, Units.METRIC, "1.20 ha"),
    ],
)
def test_small_areas_are_told_in_small_units(square_metres: float, units: Units, said: str) -> None:
    assert small_area_text(square_metres, units, words_for("en")) == said


def test_an_exclusion_covers_no_other_ground() -> None:
    picking = picking_of(FIELD)
    assert picking.exclusion_areas() == pytest.approx([16.0, 900.0, 144.0], rel=1e-3)
    assert picking.polygon.area == pytest.approx(shapely.Polygon(BOUNDARY).area - 1060.0, rel=1e-3)
