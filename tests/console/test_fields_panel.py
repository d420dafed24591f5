"""The fields panel: every way to a field ends in the preview, only the preview stores, and changes are undone."""

import io
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import numpy as np
import pytest
import viser
from PIL import Image
from support.snapshots import SetSession, field_job, field_snapshot
from support.stage import running_viser
from support.viser_client import ViserClient, viser_client

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.documents import FieldDocument
from guidance_app.model import Pose
from guidance_app.runtime import SessionManager
from guidance_app.store import Store, copy_sample
from guidance_app.store.photo_maps import list_maps

MOST_REDRAWS = 2000
SOON_S = 0.03
SQUARE = [(-40.0, -40.0), (40.0, -40.0), (40.0, 40.0), (-40.0, 40.0)]


class Yard:
    """A console in its setup place, with one client whose fields tab is used."""

    def __init__(self, house: House, screen: Screen, client: ViserClient) -> None:
        self.house = house
        self.screen = screen
        self.client = client

    def until(self, true: Callable[[], object]) -> None:
        for _ in range(MOST_REDRAWS):
            self.screen.tick()
            if self.client.soon(true, SOON_S):
                return
        told = [str(one) for one in self.client.messages if one["type"].startswith("Notification")]
        pytest.fail(f"it did not happen; told: {told}; the panels say: {self.client.words()}")

    def press(self, words: str) -> None:
        self.until(lambda: self.client.control(words))
        self.client.press(words)

    def says(self, pattern: str) -> None:
        self.until(lambda: re.search(pattern, self.client.words()) or any(self._told(pattern)))

    def _told(self, pattern: str) -> Iterator[bool]:
        for one in self.client.messages:
            if one["type"].startswith("Notification"):
                yield bool(re.search(pattern, str(one)))

    @property
    def token(self) -> str:
        """Under which the open form awaits a file: the newest, because other tabs await files too."""
        self.until(lambda: re.search(r"Nothing is stored before|Lay a photo", self.client.words()))
        return re.findall(r'data-upload="([^"]+)"', self.client.words())[-1]

    def send(self, name: str, content: bytes) -> None:
        """What the browser does with a chosen file."""
        take = self.house.files.taker(self.token)
        assert take is not None
        take(name, content)

    @property
    def names(self) -> set[str]:
        store = self.house.store
        assert store is not None
        return {one.document.name for one in store.list(FieldDocument)}


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    """viser on a free port."""
    with running_viser() as running:
        yield running


def opened(server: viser.ViserServer, manager: SessionManager, folder: Path) -> Iterator[Yard]:
    house = House(manager, Store(folder))
    screen = Screen(server, house)
    screen.attach()
    with viser_client(server) as client:
        yield Yard(house, screen, client)
    house.close()
    manager.close()


@pytest.fixture
def yard(server: viser.ViserServer, tmp_path: Path) -> Iterator[Yard]:
    """Nothing driven, the sample's documents."""
    manager = SessionManager()
    manager.start()
    yield from opened(server, manager, copy_sample(tmp_path))


@pytest.fixture
def driven_yard(server: viser.ViserServer, tmp_path: Path) -> Iterator[Yard]:
    """A drive without a field goes on while a field is registered."""
    session = SetSession(replace(field_snapshot(), plan=None, passes=()))
    session.job = field_job()
    for one in opened(server, SessionManager(session), tmp_path):
        one.press("Fields, machines, recordings")
        yield one


def shown_field(yard: Yard) -> None:
    yard.press("Show")
    yard.until(lambda: "/w/field/boundary" in yard.client.nodes)


def test_an_empty_folder_says_what_to_do_next(server: viser.ViserServer, tmp_path: Path) -> None:
    manager = SessionManager()
    for yard in opened(server, manager, tmp_path):
        yard.says("No field is registered yet")


def test_tapped_corners_become_a_field_only_after_the_preview(yard: Yard) -> None:
    shown_field(yard)
    yard.press("Tap")
    for count, (x, y) in enumerate(SQUARE, start=1):
        yard.client.tap(x, y)
        yard.says(f"{count} corners")
    assert "/w/sketch/corners" in yard.client.nodes
    yard.press("Preview")
    yard.says(r"0\.64 ha")
    assert yard.names == {"Sample field"}
    yard.client.set("Name", "Behind the barn")
    yard.press("Store this field")
    yard.until(lambda: "Behind the barn" in yard.names)


def test_a_cancelled_preview_stores_nothing_and_stops_listening(yard: Yard) -> None:
    shown_field(yard)
    yard.press("Tap")
    for x, y in SQUARE:
        yard.client.tap(x, y)
    yard.says("4 corners")
    yard.press("Cancel")
    yard.until(lambda: yard.client.control("Rename"))
    assert yard.names == {"Sample field"}
    assert "/w/sketch/corners" not in yard.client.nodes


def test_too_few_corners_and_a_crossing_ring_are_refused_in_words(yard: Yard) -> None:
    shown_field(yard)
    yard.press("Tap")
    for x, y in (SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]):
        yard.client.tap(x, y)
    yard.says("4 corners")
    yard.press("Preview")
    yard.says("crosses itself")


def test_a_name_with_markup_is_text(yard: Yard) -> None:
    shown_field(yard)
    yard.press("Change")
    yard.press("Done")
    yard.until(lambda: yard.client.control("Rename"))
    yard.client.set("Name", "<img src=x onerror=alert(1)>")
    yard.press("Rename")
    yard.until(lambda: yard.names == {"<img src=x onerror=alert(1)>"})
    yard.until(lambda: yard.client.control("Rename"))
    assert "<img src=x onerror=alert(1)>" not in "".join(
        str(one["props"].get("content", "")) for one in yard.client.controls.values()
    )


def test_a_deleted_field_comes_back_with_its_operations(yard: Yard) -> None:
    yard.press("Delete")
    yard.until(lambda: yard.names == set())
    yard.until(lambda: "Bring '" in yard.client.words())
    words = next(
        one["props"]["label"] for one in yard.client.controls.values() if "Bring '" in str(one["props"].get("label"))
    )
    yard.press(words)
    yard.until(lambda: yard.names == {"Sample field"})


def test_a_moved_corner_is_stored_and_undone(yard: Yard) -> None:
    store = yard.house.store
    assert store is not None
    before = store.load(FieldDocument, "Sample field").document
    yard.press("Change")
    yard.until(lambda: "/w/sketch/corners" in yard.client.nodes)
    yard.says("Tap a corner")
    yard.client.tap(-500.0, -500.0)
    yard.until(lambda: "/w/sketch/chosen" in yard.client.nodes)
    yard.client.tap(-70.0, -95.0)
    yard.until(lambda: store.load(FieldDocument, "Sample field").document != before)
    yard.press("Undo")
    yard.until(lambda: store.load(FieldDocument, "Sample field").document == before)


def test_a_field_that_is_cut_in_two_leaves_two_and_the_whole_in_the_trash(yard: Yard) -> None:
    yard.press("Change")
    yard.says("Tap a corner")
    yard.client.set("Change", "Cut in two")
    yard.says("along the cut")
    yard.client.tap(-60.0, 5.0)
    yard.client.tap(60.0, 5.0)
    yard.press("Finish")
    yard.until(lambda: yard.names == {"Sample field 1", "Sample field 2"})


def test_a_file_is_shown_before_it_is_stored(yard: Yard, tmp_path: Path) -> None:
    ring = "[[8.5,47.5],[8.501,47.5],[8.501,47.501],[8.5,47.501],[8.5,47.5]]"
    content = f'{{"type":"Polygon","coordinates":[{ring}]}}'.encode()
    yard.press("File")
    token = yard.token
    yard.send("../../Große Wiese.geojson", content)
    yard.says("from")
    yard.press("Store this field")
    yard.until(lambda: "Große Wiese" in yard.names)
    assert yard.house.files.taker(token) is None


def test_a_file_that_is_no_field_is_refused_with_its_name(yard: Yard) -> None:
    yard.press("File")
    yard.send("holiday.geojson", b"not a field")
    yard.says(r"holiday\.geojson")


def test_typed_corners_are_read_back_before_they_become_a_field(yard: Yard) -> None:
    yard.press("Type")
    yard.says("At least 4 corners")
    yard.client.set(
        "One corner a line", "47,5000 N 8,5000 E\n47,5000 N 8,5020 E\n47.5010, 8.5020\n47 30 3.6 N, 8 30 0 E"
    )
    yard.press("Check")
    yard.says("latitude 47.501")
    yard.press("Preview")
    yard.says(r"1\.6\d ha")
    yard.press("Store this field")
    yard.until(lambda: "New field" in yard.names)


def test_a_line_that_is_no_corner_is_named(yard: Yard) -> None:
    yard.press("Type")
    yard.says("At least 4 corners")
    yard.client.set("One corner a line", "47.5, 8.5\n47.5, eight\n47.6, 8.6")
    yard.press("Preview")
    yard.says("Line 2")
    assert yard.names == {"Sample field"}


def test_a_list_in_metres_asks_for_its_zone_and_is_read_again(yard: Yard) -> None:
    yard.press("File")
    rows = "462300,5260900\n462500,5260900\n462500,5261100\n462300,5261100\n"
    yard.send("corners.csv", f"easting,northing\n{rows}".encode())
    yard.says("What the file does not say")
    yard.client.set("Coordinates", "UTM")
    yard.client.set("Zone", "32")
    yard.client.set("Use these", value=True)
    yard.press("Read the file again")
    yard.says(r"[34]\.\d\d ha")
    yard.press("Store this field")
    yard.until(lambda: len(yard.names) == 2)


def test_a_field_is_drawn_over_a_photo_that_two_points_lay(yard: Yard) -> None:
    made = io.BytesIO()
    Image.new("RGB", (400, 300), (40, 120, 60)).save(made, "PNG")
    yard.press("Photo")
    yard.send("from above.png", made.getvalue())
    yard.until(lambda: "/w/sketch/picture" in yard.client.nodes)
    for spot, place in (((-50.0, 0.0), "47.5000, 8.5000"), ((50.0, 0.0), "47.5000, 8.5040")):
        yard.client.tap(*spot)
        yard.until(lambda: "/w/sketch/spot" in yard.client.nodes)
        yard.client.set("Latitude, longitude of the spot", place)
        yard.press("As typed")
        yard.until(lambda: "/w/sketch/spot" not in yard.client.nodes)
    yard.says("a pixel is")
    yard.press("Keep the map")
    store = yard.house.store
    assert store is not None
    yard.until(lambda: [one.document.name for one in list_maps(store.root)] == ["from above"])
    yard.press("Done")
    yard.press("Tap")
    yard.says("Tap each corner")
    for x, y in SQUARE:
        yard.client.tap(x, y)
    yard.says("4 corners")
    yard.press("Preview")
    yard.press("Store this field")
    yard.until(lambda: "New field" in yard.names)


def test_a_picture_that_is_none_is_refused_and_spots_need_a_tap(yard: Yard) -> None:
    yard.press("Photo")
    yard.send("notes.png", b"nothing")
    yard.says(r"notes\.png is no picture")
    yard.client.set("Latitude, longitude of the spot", "47.5, 8.5")
    yard.press("As typed")
    yard.says("Tap the spot")


def test_a_boundary_is_driven_while_the_drive_goes_on(driven_yard: Yard) -> None:
    yard = driven_yard
    yard.press("Drive")
    yard.press("Start here")
    yard.says("to the start")
    session = yard.house.manager.session
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
    yard.press("Close the ring and preview")
    yard.says(r"0\.7[789] ha")
    yard.press("Store this field")
    yard.until(lambda: "New field" in yard.names)
    assert yard.house.driving
    assert session.commands == []


def test_an_export_leaves_by_http_address(yard: Yard) -> None:
    yard.until(lambda: "/download/" in yard.client.words())
    address = re.search(r"/download/([\w-]+)", yard.client.words())
    assert address is not None
    make = yard.house.files.maker(address[1])
    assert make is not None
    made = make()
    assert made is not None
    assert made.name.startswith("Sample field.")
    assert len(made.data) > 100
    assert httpx.URL(f"/download/{address[1]}").path
