"""What a browser shows when the console freezes, dies, comes back, loses its picture or asks for a PIN."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect
from support.chromium import (
    PHONE,
    TABLET,
    WITHOUT_DRAWING,
    OpenPage,
    assert_silent_at_the_first_look,
    save_screenshot,
)
from support.console_process import ConsoleProcess, console_process
from support.consoles import StartConsole

pytestmark = pytest.mark.browser

LOST = (r"ERR_CONNECTION_REFUSED", r"ERR_CONNECTION_RESET", r"ERR_EMPTY_RESPONSE", r"WebSocket")
"""What a browser writes into its log while nobody answers."""
UNAUTHORISED = r"status of 401"


def in_state(page: Page, state: str) -> None:
    expect(page.locator("#lightbar")).to_have_attribute("data-state", state)


@pytest.fixture(scope="module")
def process() -> Iterator[ConsoleProcess]:
    """A console that may be frozen and, by the last test that takes it, killed."""
    with console_process() as running:
        yield running


def test_a_frozen_console_says_no_data_within_a_second_and_comes_back(
    process: ConsoleProcess, open_page: OpenPage
) -> None:
    page = open_page(process.address, script=WITHOUT_DRAWING, allow=LOST)
    in_state(page, "guide")
    process.freeze()
    in_state(page, "silent")
    assert_silent_at_the_first_look(page)
    assert page.evaluate("window.__lightbar.drawn.reason") == "NO DATA"
    bar = page.locator("#lightbar")
    assert bar.get_attribute("data-cross-track") == ""
    assert bar.locator("canvas").get_attribute("aria-label") == "NO DATA"
    assert bar.locator(".side.left").is_hidden()
    save_screenshot(page, "bar-no-data")
    page.wait_for_function("Date.now() - window.__lightbar.silentSince > 3500")
    process.thaw()
    in_state(page, "guide")
    assert page.evaluate("window.__lightbar.connections") >= 2


def test_a_console_that_was_started_anew_gets_a_fresh_page(process: ConsoleProcess, open_page: OpenPage) -> None:
    page = open_page(process.address, script=WITHOUT_DRAWING, allow=LOST)
    in_state(page, "guide")
    page.evaluate("window.older = true")
    process.end()
    in_state(page, "silent")
    with console_process(process.port):
        page.wait_for_function("window.older === undefined && window.__lightbar?.state === 'guide'")
        page.wait_for_selector("#root canvas")


def test_a_lost_picture_starts_the_page_anew(start_console: StartConsole, open_page: OpenPage) -> None:
    page = open_page(start_console().addresses[0], allow=(r"THREE.WebGLRenderer: Context Lost",))
    page.wait_for_selector("#root canvas")
    page.evaluate("window.older = true")
    page.wait_for_function(
        """() => {
          const canvas = document.querySelector('#root canvas');
          const context = canvas?.getContext('webgl2') ?? canvas?.getContext('webgl');
          const loss = context?.getExtension('WEBGL_lose_context');
          loss?.loseContext();
          return Boolean(loss);
        }"""
    )
    page.wait_for_function("window.older === undefined && window.__lightbar !== undefined")


# --- the PIN -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [TABLET, PHONE])
def test_the_keypad_opens_the_console(start_console: StartConsole, open_page: OpenPage, size: tuple[int, int]) -> None:
    console = start_console(lan=True, pin="480215")
    page = open_page(console.addresses[0], size=size, touch=True, script=WITHOUT_DRAWING, allow=(UNAUTHORISED,))
    save_screenshot(page, f"pin-{size[0]}x{size[1]}")
    for key in page.locator(".keys button").all():
        box = key.bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 60
    tap(page, "999999")
    expect(page.locator(".message")).to_have_text("Wrong PIN. 4 tries left.")
    tap(page, "48021")
    page.get_by_role("button", name="Delete the last digit").tap()
    tap(page, "15")
    page.wait_for_function("window.__lightbar?.state === 'connecting'")
    assert page.url == f"{console.addresses[0]}/"


def test_after_too_many_wrong_pins_the_page_counts_down(start_console: StartConsole, open_page: OpenPage) -> None:
    console = start_console(lan=True, pin="480215")
    page = open_page(console.addresses[0], touch=True, allow=(UNAUTHORISED,))
    for tries in (4, 3, 2, 1):
        tap(page, "999999")
        expect(page.locator(".message")).to_have_text(f"Wrong PIN. {tries} {'try' if tries == 1 else 'tries'} left.")
    tap(page, "999999")
    expect(page.locator(".message")).to_contain_text("Wait 5")
    expect(page.locator("body")).to_have_class("waiting")


def test_the_link_of_the_qr_code_needs_no_typing(start_console: StartConsole, open_page: OpenPage) -> None:
    console = start_console(lan=True, pin="480215")
    page = open_page(f"{console.addresses[0]}/?pin=480215", script=WITHOUT_DRAWING, allow=(UNAUTHORISED,))
    page.wait_for_function("window.__lightbar?.state === 'connecting'")
    assert page.url == f"{console.addresses[0]}/"


def tap(page: Page, digits: str) -> None:
    for digit in digits:
        page.get_by_role("button", name=digit, exact=True).tap()


def test_a_console_started_anew_on_a_network_asks_for_its_new_pin(
    start_console: StartConsole, open_page: OpenPage
) -> None:
    first = start_console(lan=True, pin="480215")
    port = int(first.addresses[0].rpartition(":")[2])
    link = f"{first.addresses[0]}/?pin=480215"
    page = open_page(link, touch=True, script=WITHOUT_DRAWING, allow=(*LOST, UNAUTHORISED))
    page.wait_for_function("window.__lightbar?.state === 'connecting'")
    first.close()
    in_state(page, "silent")
    start_console(lan=True, pin="111222", port=port)
    expect(page.locator(".keys")).to_be_visible()
    tap(page, "111222")
    page.wait_for_function("window.__lightbar?.state === 'connecting'")
