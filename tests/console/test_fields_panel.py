"""The fields panel: every way to a field ends in the preview, only the preview stores, and changes are undone."""

import io
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import viser
from PIL import Image
from support.setup_place import SetupPlace, setup_place
from support.snapshots import SetSession, field_job, field_snapshot

from guidance_app.documents import FieldDocument, Operation
from guidance_app.model import Pose
from guidance_app.store import copy_sample
from guidance_app.store.photo_maps import list_maps

SQUARE = [(-40.0, -40.0), (40.0, -40.0), (40.0, 40.0), (-40.0, 40.0)]


WELL_ABOVE = 100.0
"""Metres from which a field is seen as a whole; the driver's eyes are below 5 m."""
TYPE, FILE, PHOTO = "At least 4 corners", "Nothing is stored before", "Choose a photo or a scanned map"


@pytest.fixture
def place(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """Nothing driven, the sample's documents."""
    with setup_place(server, copy_sample(tmp_path)) as one:
        yield one


@pytest.fixture
def driven_place(server: viser.ViserServer, tmp_path: Path) -> Iterator[SetupPlace]:
    """A drive without a field goes on while a field is registered."""
    session = SetSession(replace(field_snapshot(), plan=None, passes=()))
    session.job = field_job()
    with setup_place(server, tmp_path, session) as one:
        one.press("Fields, machines, recordings")
        yield one


def shown_field(place: SetupPlace) -> None:
    place.press("Show")
    place.sees("/w/field/boundary")


def tapped(place: SetupPlace, corners: Sequence[tuple[float, float]] = SQUARE) -> None:
    """These corners, one after the other."""
    place.press("Tap")
    place.says("Tap each corner")
    for x, y in corners:
        place.client.tap(x, y)
    place.says(f"{len(corners)} corners")


def way(place: SetupPlace, name: str, said: str) -> None:
    """One of the ways to a field, open."""
    place.press(name)
    place.says(said)


def test_an_empty_folder_says_what_to_do_next(server: viser.ViserServer, tmp_path: Path) -> None:
    with setup_place(server, tmp_path) as place:
        place.says("No field is registered yet")


def test_tapped_corners_become_a_field_only_after_the_preview(place: SetupPlace) -> None:
    shown_field(place)
    tapped(place)
    place.sees("/w/sketch/corners", "/w/sketch/edges")
    place.press("Preview")
    place.says(r"0\.64 ha")
    assert place.names(FieldDocument) == ["Sample field"]
    place.fill("Name", "Behind the barn")
    place.press("Store this field")
    place.until(lambda: "Behind the barn" in place.names(FieldDocument))


def test_a_cancelled_preview_stores_nothing_and_stops_listening(place: SetupPlace) -> None:
    shown_field(place)
    tapped(place)
    place.press("Cancel")
    place.until(lambda: place.newest("Rename"))
    place.sees_no("/w/sketch/corners", "/w/sketch/edges")
    assert place.names(FieldDocument) == ["Sample field"]


def test_too_few_corners_and_a_crossing_ring_are_refused_in_words(place: SetupPlace) -> None:
    shown_field(place)
    tapped(place, [SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]])
    place.press("Preview")
    place.says("crosses itself")


def named(place: SetupPlace, name: str) -> None:
    """The list is there again, with this field chosen."""
    place.until(lambda: place.newest("Rename") and (one := place.newest("Field")) and one["value"] == name)


def test_a_name_with_markup_is_text(place: SetupPlace) -> None:
    shown_field(place)
    place.press("Change")
    place.press("Done")
    named(place, "Sample field")
    place.fill("Name", "<img src=x onerror=alert(1)>")
    place.press("Rename")
    place.until(lambda: place.names(FieldDocument) == ["<img src=x onerror=alert(1)>"])
    named(place, "<img src=x onerror=alert(1)>")
    assert "<img src=x onerror=alert(1)>" not in "".join(
        str(one["props"].get("content", "")) for one in place.client.controls.values()
    )


def test_a_deleted_field_comes_back_with_its_operations(place: SetupPlace) -> None:
    place.press("Delete")
    place.until(lambda: place.names(FieldDocument) == [])
    assert place.names(Operation) == []
    place.press(place.label("Bring '"))
    place.until(lambda: place.names(FieldDocument) == ["Sample field"])
    assert place.names(Operation) == ["Round trip"]


def test_a_moved_corner_is_stored_and_undone(place: SetupPlace) -> None:
    store = place.store
    before = store.load(FieldDocument, "Sample field").document
    place.press("Change")
    place.sees("/w/sketch/corners")
    place.says("Tap a corner")
    place.client.tap(-500.0, -500.0)
    place.sees("/w/sketch/chosen")
    drawn = len(place.client.heard("LineSegmentsMessage", name="/w/sketch/corners"))
    place.client.tap(-70.0, -95.0)
    place.until(lambda: store.load(FieldDocument, "Sample field").document != before)
    place.until(lambda: len(place.client.heard("LineSegmentsMessage", name="/w/sketch/corners")) > drawn)
    height = place.client.heard("SetCameraPositionMessage")[-1]["position"][2]
    assert height > WELL_ABOVE, "the whole field is still in sight"
    place.press("Undo")
    place.until(lambda: store.load(FieldDocument, "Sample field").document == before)


def test_a_field_that_is_cut_in_two_leaves_two_and_the_whole_in_the_trash(place: SetupPlace) -> None:
    place.press("Change")
    place.says("Tap a corner")
    place.fill("Change", "Cut in two")
    place.says("along the cut")
    place.client.tap(-60.0, 5.0)
    place.client.tap(60.0, 5.0)
    place.press("Finish")
    place.until(lambda: place.names(FieldDocument) == ["Sample field 1", "Sample field 2"])


def test_a_file_is_shown_before_it_is_stored(place: SetupPlace, tmp_path: Path) -> None:
    ring = "[[8.5,47.5],[8.501,47.5],[8.501,47.501],[8.5,47.501],[8.5,47.5]]"
    content = f'{{"type":"Polygon","coordinates":[{ring}]}}'.encode()
    place.press("File")
    token = place.token(FILE)
    place.send(FILE, "../../Große Wiese.geojson", content)
    place.says("from")
    place.press("Store this field")
    place.until(lambda: "Große Wiese" in place.names(FieldDocument))
    assert place.house.files.taker(token) is None


def test_a_file_that_is_no_field_is_refused_with_its_name(place: SetupPlace) -> None:
    place.press("File")
    place.send(FILE, "holiday.geojson", b"not a field")
    place.says(r"holiday\.geojson")


def test_typed_corners_are_read_back_before_they_become_a_field(place: SetupPlace) -> None:
    way(place, "Type", TYPE)
    place.fill("One corner a line", "47,5000 N 8,5000 E\n47,5000 N 8,5020 E\n47.5010, 8.5020\n47 30 3.6 N, 8 30 0 E")
    place.press("Check")
    place.says("latitude 47.501")
    place.press("Preview")
    place.says(r"1\.6\d ha")
    place.press("Store this field")
    place.until(lambda: "New field" in place.names(FieldDocument))


def test_a_line_that_is_no_corner_is_named(place: SetupPlace) -> None:
    way(place, "Type", TYPE)
    place.fill("One corner a line", "47.5, 8.5\n47.5, eight\n47.6, 8.6")
    place.press("Preview")
    place.says("Line 2")
    assert place.names(FieldDocument) == ["Sample field"]


def test_a_list_in_metres_asks_for_its_zone_and_is_read_again(place: SetupPlace) -> None:
    place.press("File")
    rows = "462300,5260900\n462500,5260900\n462500,5261100\n462300,5261100\n"
    place.send(FILE, "corners.csv", f"easting,northing\n{rows}".encode())
    place.says("What the file does not say")
    place.fill("Coordinates", "UTM")
    place.fill("Zone", "32")
    place.fill("Use these", value=True)
    place.press("Read the file again")
    place.says(r"[34]\.\d\d ha")
    place.press("Store this field")
    place.until(lambda: len(place.names(FieldDocument)) == 2)


def test_a_field_is_drawn_over_a_photo_that_two_points_lay(place: SetupPlace) -> None:
    made = io.BytesIO()
    Image.new("RGB", (400, 300), (40, 120, 60)).save(made, "PNG")
    place.press("Photo")
    place.send(PHOTO, "from above.png", made.getvalue())
    place.sees("/w/sketch/picture")
    for spot, typed in (((-50.0, 0.0), "47.5000, 8.5000"), ((50.0, 0.0), "47.5000, 8.5040")):
        place.client.tap(*spot)
        place.sees("/w/sketch/spot")
        place.fill("Latitude, longitude of the spot", typed)
        place.press("As typed")
        place.sees_no("/w/sketch/spot")
    place.says("a pixel is")
    place.press("Keep the map")
    store = place.store
    place.until(lambda: [one.document.name for one in list_maps(store.root)] == ["from above"])
    place.press("Done")
    tapped(place)
    place.press("Preview")
    place.press("Store this field")
    place.until(lambda: "New field" in place.names(FieldDocument))


def test_a_photo_far_from_the_field_on_the_map_is_not_laid(place: SetupPlace) -> None:
    shown_field(place)
    made = io.BytesIO()
    Image.new("RGB", (400, 300), (40, 120, 60)).save(made, "PNG")
    place.press("Photo")
    place.send(PHOTO, "from above.png", made.getvalue())
    place.sees("/w/sketch/picture")
    for count, spot in enumerate(((-50.0, 0.0), (50.0, 0.0)), start=1):
        place.client.tap(*spot)
        place.sees("/w/sketch/spot")
        place.fill("Latitude, longitude of the spot", f"47.5000, 8.500{count}")
        place.press("As typed")
        place.says("Spot 1")
    place.says("more than 100 km from the field")
    place.press("Undo")
    place.sees_no("/w/sketch/spot")
    place.press("Undo")
    place.until(lambda: "Spot 1" not in place.client.words())


def test_a_picture_that_is_none_is_refused_and_spots_need_a_tap(place: SetupPlace) -> None:
    place.press("Photo")
    place.send(PHOTO, "notes.png", b"nothing")
    place.says(r"notes\.png is no picture")
    place.fill("Latitude, longitude of the spot", "47.5, 8.5")
    place.press("As typed")
    place.says("Tap the spot")


def test_a_boundary_is_driven_while_the_drive_goes_on(driven_place: SetupPlace) -> None:
    place = driven_place
    place.press("Drive")
    place.press("Start here")
    place.says("to the start")
    session = place.house.manager.session
    assert isinstance(session, SetSession)
    for index in range(330):
        angle = index / 330 * 2 * np.pi
        pose = Pose(
            t=index * 0.5,
            arrival=index * 0.5,
            east=50 * np.sin(angle),
            north=50 * np.cos(angle),
            heading=angle + np.pi / 2,
            speed=2.0,
        )
        snapshot = session.snapshot()
        session.publish(replace(snapshot, pose=pose, implement=(pose.east, pose.north, pose.heading), sequence=index))
    place.press("Close the ring and preview")
    place.says(r"0\.7[789] ha")
    place.press("Store this field")
    place.until(lambda: "New field" in place.names(FieldDocument))
    assert place.house.driving
    assert session.commands == []


def test_an_export_leaves_by_http_address(place: SetupPlace) -> None:
    made = place.made("GeoJSON")
    assert made.name == "Sample field.geojson"
    assert len(made.data) > 100
