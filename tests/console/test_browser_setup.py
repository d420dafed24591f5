"""Somebody who has never seen it registers machines and an operation with fingers, and starts it by its name."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect
from support.chromium import PHONE, SIZES, TABLET, WITHOUT_DRAWING, OpenPage, save_screenshot
from support.consoles import running_console

from guidance_app.console.screen import Screen
from guidance_app.console.server import Console
from guidance_app.documents import Implement, Operation, Tractor
from guidance_app.runtime import SessionManager
from guidance_app.store import Store, copy_sample

pytestmark = pytest.mark.browser

LEAST_TOUCH = 38
"""CSS pixels that a gloved finger meets; at the sizes of a tablet in the cab."""


@pytest.fixture
def console(tmp_path: Path) -> Iterator[Console]:
    """A console with the sample field, and with no machine and no operation."""
    data = copy_sample(tmp_path)
    for gone in ("tractors", "implements", "receivers", "fields/sample-field/operations", "recordings"):
        (data / gone).rename(data / f"aside-{gone.replace('/', '-')}")
    manager = SessionManager()
    manager.start()
    with running_console(manager, screen_factory=Screen, store=Store(data)) as running:
        yield running
    manager.close()


def opened(console: Console, open_page: OpenPage, size: tuple[int, int] = TABLET) -> Page:
    page = open_page(console.addresses[0], size=size, touch=True, script=WITHOUT_DRAWING)
    expect(page.get_by_role("tab", name="Machines")).to_be_visible()
    page.add_style_tag(content=".mantine-Notifications-root{display:none}")
    return page


def entry(page: Page, title: str) -> Locator:
    """The input behind this label, in the panel that is open."""
    label = page.locator("label").filter(has_text=re.compile(f"^{re.escape(title)}"))
    return label.locator("xpath=ancestor::div[2]").locator("input:visible").first


def press(page: Page, words: str) -> None:
    button = page.get_by_role("button", name=words, exact=True)
    expect(button).to_be_visible()
    box = button.bounding_box()
    assert box is not None
    assert box["height"] >= LEAST_TOUCH, f"{words}: {box['height']} px are too small for a glove"
    button.tap()


def registered(page: Page, shelf: str, new: str, entries: dict[str, str]) -> None:
    """Registers one machine by fingers."""
    page.get_by_role("tab", name="Machines").tap()
    press(page, shelf)
    press(page, new)
    for title, typed in entries.items():
        entry(page, title).fill(typed)
    press(page, "Save")
    expect(page.get_by_text(f"'{entries['Name']}' is stored")).to_be_visible()
    press(page, "Back")


def test_from_nothing_to_a_drive_by_name(console: Console, open_page: OpenPage) -> None:
    store = console.house.store
    assert store is not None
    page = opened(console, open_page)
    expect(page.get_by_text("☐ Register a tractor")).to_be_visible()
    registered(page, "Tractors", "New tractor", {"Name": "Iseki", "Wheelbase": "2,1", "Antenna right": "-0,2"})
    registered(page, "Implements", "New implement", {"Name": "Drill 3 m", "Working width": "3"})
    assert store.load(Tractor, "Iseki").document.antenna_right == -0.2
    assert store.load(Implement, "Drill 3 m").document.working_width == 3.0
    page.get_by_role("tab", name="Jobs").tap()
    press(page, "New operation")
    entry(page, "Name").fill("Sowing 2027")
    entry(page, "Field").tap()
    expect(entry(page, "Field")).to_have_attribute("inputmode", "none")
    page.keyboard.press("Escape")
    page.locator(".g-card", has_text="Transfer").tap()
    expect(entry(page, "Passes left out")).to_be_visible()
    entry(page, "Passes left out").tap()
    expect(entry(page, "Passes left out")).to_have_attribute("inputmode", "numeric")
    press(page, "Show the plan on the map")
    expect(page.get_by_text("way worked")).to_be_visible()
    press(page, "Save")
    expect(page.get_by_text("'Sowing 2027' is stored")).to_be_visible()
    operation = store.load(Operation, "Sowing 2027").document
    assert (operation.method, operation.tractor, operation.implement) == ("transfer", "Iseki", "Drill 3 m")
    page.get_by_role("tab", name="Start").tap()
    press(page, "▶ Sowing 2027")
    expect(page.get_by_text("Sample field · Sowing 2027")).to_be_visible()
    assert console.house.driving


def test_a_casters_password_is_dots(console: Console, open_page: OpenPage) -> None:
    page = opened(console, open_page)
    page.get_by_role("tab", name="Receiver").tap()
    page.get_by_text("Corrections (NTRIP)").tap()
    for title, security in (("User", "none"), ("Password", "disc")):
        entry(page, title).tap()
        entry(page, title).fill("s3cret")
        expect(entry(page, title)).to_have_css("-webkit-text-security", security)
    expect(entry(page, "Password")).to_have_attribute("autocomplete", "off")


def test_markup_in_names_is_text_everywhere(console: Console, open_page: OpenPage) -> None:
    store = console.house.store
    assert store is not None
    nasty = "<img src=x onerror=window.__bad=1>"
    store.save(Tractor(name=nasty))
    store.save(Implement(name=nasty))
    store.save(Operation(name=nasty, field="Sample field", tractor=nasty, implement=nasty))
    page = opened(console, open_page)
    expect(page.get_by_text(nasty).first).to_be_visible()
    page.get_by_role("tab", name="Jobs").tap()
    page.get_by_role("button", name=f"{nasty} · Sample field").tap()
    expect(entry(page, "Tractor")).to_have_value(nasty)
    page.get_by_role("tab", name="Machines").tap()
    press(page, "Tractors")
    page.get_by_role("button", name=re.compile("^<img")).tap()
    press(page, "Delete")
    expect(page.get_by_text(f"It is missing in: {nasty}")).to_be_visible()
    assert page.evaluate("window.__bad") is None


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_forms_fit_every_screen(console: Console, open_page: OpenPage, size: tuple[int, int]) -> None:
    page = opened(console, open_page, size)
    page.get_by_role("tab", name="Machines").tap()
    press(page, "Tractors")
    press(page, "New tractor")
    field = entry(page, "Wheelbase")
    expect(field).to_be_visible()
    field.fill("99")
    press(page, "Save")
    expect(page.get_by_text("Must be 0.5 to 8 m.")).to_be_visible()
    box = field.bounding_box()
    assert box is not None
    assert box["height"] >= LEAST_TOUCH - 4
    assert box["x"] + box["width"] <= size[0]
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    save_screenshot(page, f"tractor-{size[0]}x{size[1]}")


PICTURE_ABOVE_THE_SHEET = """(least) => {
  const picture = document.querySelector("#root canvas[data-engine]")?.getBoundingClientRect();
  const sheet = [...document.querySelectorAll("#root .mantine-Paper-root")]
    .find((one) => getComputedStyle(one).position === "fixed")?.getBoundingClientRect();
  return picture && sheet && Math.abs(picture.bottom - sheet.top) <= 1 && picture.height >= least;
}"""


def test_on_a_phone_the_picture_is_what_the_panels_leave(console: Console, open_page: OpenPage) -> None:
    """The whole of it is in sight: a little beside a form, and nearly all of the screen after one tap."""
    page = opened(console, open_page, PHONE)
    page.wait_for_function(PICTURE_ABOVE_THE_SHEET, arg=120)
    page.get_by_text("Setup", exact=True).tap()
    page.wait_for_function(PICTURE_ABOVE_THE_SHEET, arg=500)
    page.get_by_text("Setup", exact=True).tap()
    page.get_by_role("tab", name="Machines").tap()
    press(page, "Tractors")
    page.wait_for_function(PICTURE_ABOVE_THE_SHEET, arg=120)
    assert page.evaluate("document.scrollingElement.scrollWidth") <= PHONE[0]
