"""The scene in a real browser: true colours, its place under the camera, fingers, views, night, at three sizes."""

import io
import math
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect
from support.chromium import PHONE, SIZES, SMALL_TABLET, TABLET, WITHOUT_DRAWING, OpenPage, save_screenshot
from support.consoles import running_console
from support.snapshots import SetSession, field_job, field_snapshot, strip, trail

from guidance_app.console.screen import Screen
from guidance_app.console.server import Console
from guidance_app.model import SetWorkMode, SkipPass, Snapshot, WorkMode
from guidance_app.view.colours import DAY, NIGHT, Rgb

pytestmark = pytest.mark.browser

HARDLY_SEEN = 14
"""A difference of a colour's part, of 255: haze, smoothing and the curve's rounding together."""

TENTH_OF_THE_WINDOW = 0.1
CANVAS = "canvas[data-engine]"
"""The scene's canvas: three.js marks it; others belong to the light bar and to viser's selections."""

HOW_FAR = "Math.hypot(...window.__viserMutable.camera.position.toArray().map((v, k) => v - home[k]))"


def at_work(**members: object) -> Snapshot:
    """A field half done."""
    lines = [np.array([[6.0 + 6.0 * k, 12.0], [6.0 + 6.0 * k, 160.0]]) for k in range(2)]
    half = np.array([[18.0, 12.0], [18.0, 58.0]])
    worked = trail([strip(k, line) for k, line in enumerate(lines)], strip(2, half, sealed=False))
    return field_snapshot(worked=worked, track=trail(lines, half), **members)


class Drive:
    """A console on a snapshot that a test replaces."""

    def __init__(self, console: Console, session: SetSession) -> None:
        self.console = console
        self.session = session

    @property
    def address(self) -> str:
        return self.console.addresses[0]


@pytest.fixture(scope="module")
def drive() -> Iterator[Drive]:
    """One console with the real screen for all tests here."""
    session = SetSession(at_work(), field_job())
    with running_console(session, screen_factory=Screen) as console:
        yield Drive(console, session)


@pytest.fixture(autouse=True)
def as_before(drive: Drive) -> None:
    drive.session.publish(at_work())
    drive.session.commands.clear()


def with_scene(page: Page) -> Page:
    """The page, once everything is drawn and viser's remark about software drawing is away."""
    page.wait_for_function("window.__viserMutable?.nodeRefFromName['/w/worked_open']")
    page.wait_for_function("window.__viserMutable.nodeRefFromName['/w/here/tractor']")
    page.add_style_tag(content=".mantine-Notifications-root{display:none}")
    settled(page)
    return page


def settled(page: Page) -> None:
    """Waits for three pictures, so that what was assigned is drawn."""
    page.evaluate("async () => { for (let k = 0; k < 3; k++) await new Promise(requestAnimationFrame) }")


def seen_at(page: Page, name: str) -> tuple[float, float]:
    """Where a node is seen in the canvas: (right, up), each -1 to 1."""
    script = """(name) => {
        const { nodeRefFromName, camera } = window.__viserMutable;
        const place = nodeRefFromName[name].getWorldPosition(camera.position.clone());
        const seen = place.project(camera);
        return [seen.x, seen.y];
    }"""
    right, up = page.evaluate(script, name)
    return float(right), float(up)


def colour_share(page: Page, colour: Rgb, near: int = HARDLY_SEEN) -> float:
    """Which share of the canvas has about this colour."""
    picture = Image.open(io.BytesIO(page.locator(CANVAS).screenshot())).convert("RGB")
    away = np.abs(np.asarray(picture, dtype=int) - colour).max(axis=2)
    return float((away <= near).mean())


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_the_scene_is_there_at_every_size(drive: Drive, open_page: OpenPage, size: tuple[int, int]) -> None:
    page = with_scene(open_page(drive.address, size=size, touch=True))
    right, up = seen_at(page, "/w/here")
    assert abs(right) < TENTH_OF_THE_WINDOW
    assert -0.9 < up < 0.4
    expect(page.get_by_text("Long Acre · Implement")).to_be_visible()
    expect(page.get_by_text("Working · press to lift")).to_be_visible()
    save_screenshot(page, f"scene_{size[0]}x{size[1]}")


def test_the_ground_has_its_true_colours_by_day_and_night(drive: Drive, open_page: OpenPage) -> None:
    page = with_scene(open_page(drive.address, size=TABLET, touch=True))
    page.get_by_text("Views", exact=True).tap()
    page.get_by_text("Whole field", exact=True).tap()
    for words, palette, scheme in (("Night", NIGHT, "dark"), ("Day", DAY, "light")):
        page.get_by_role("button", name=words).tap()
        page.wait_for_selector(f'html[data-mantine-color-scheme="{scheme}"]', state="attached")
        settled(page)
        assert colour_share(page, palette.soil) > 0.08
        assert colour_share(page, palette.meadow) > 0.2
        save_screenshot(page, f"whole_field_{words.lower()}")


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_the_whole_field_is_in_sight(drive: Drive, open_page: OpenPage, size: tuple[int, int]) -> None:
    page = with_scene(open_page(drive.address, size=size, touch=True, script=WITHOUT_DRAWING))
    if size == PHONE:
        page.get_by_text(re.compile("^Work · ")).tap()
    page.get_by_text("Views", exact=True).tap()
    page.get_by_text("Whole field", exact=True).tap()
    page.wait_for_function("window.__viserMutable.camera.position.length() > 100")
    settled(page)
    for name in ("/w/flags/start", "/w/flags/entrance"):
        right, up = seen_at(page, name)
        assert abs(right) < 1.0
        assert abs(up) < 1.0


def test_a_finger_turns_the_view_and_one_button_brings_it_back(drive: Drive, open_page: OpenPage) -> None:
    page = with_scene(open_page(drive.address, size=SMALL_TABLET, script=WITHOUT_DRAWING))
    place = "() => window.__viserMutable.camera.position.toArray()"
    home = page.evaluate(place)
    box = page.locator(CANVAS).bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 3
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 90, y + 20, steps=6)
    page.mouse.up()
    page.wait_for_function(f"(home) => {HOW_FAR} > 2", arg=home)
    page.get_by_text("Views", exact=True).click()
    page.get_by_text("Bring back", exact=True).click()
    page.wait_for_function(f"(home) => {HOW_FAR} < 0.05", arg=home)


def test_buttons_are_large_enough_for_a_thumb_and_reach_the_session(drive: Drive, open_page: OpenPage) -> None:
    page = with_scene(open_page(drive.address, size=SMALL_TABLET, touch=True, script=WITHOUT_DRAWING))
    for words, command in (("Skip", SkipPass()), ("Speed", SetWorkMode(WorkMode.SPEED))):
        button = page.get_by_role("button", name=words)
        box = button.bounding_box()
        assert box is not None
        assert box["height"] >= 42.0
        assert box["y"] + box["height"] <= SMALL_TABLET[1], f"{words} needs scrolling"
        button.tap()
        drive.session.until_posted(command)


def test_the_tractor_stays_where_it_is_on_the_screen_while_the_world_moves(drive: Drive, open_page: OpenPage) -> None:
    page = with_scene(open_page(drive.address, size=TABLET, script=WITHOUT_DRAWING))
    before = seen_at(page, "/w/here")
    world = "() => window.__viserMutable.nodeRefFromName['/w'].position.toArray()"
    stood = page.evaluate(world)
    pose = drive.session.snapshot().pose
    assert pose is not None
    moved = replace(pose, north=pose.north + 20.0)
    drive.session.publish(replace(at_work(), pose=moved, implement=(moved.east, moved.north - 1.5, 0.0), sequence=9))
    page.wait_for_function(f"(stood) => Math.abs(({world})()[0] - stood[0]) > 19", arg=stood)
    settled(page)
    assert math.dist(before, seen_at(page, "/w/here")) < 0.01
