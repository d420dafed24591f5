"""The light bar in a real browser: what is drawn, at three sizes, by day and night, and when nothing is heard."""

import functools
import itertools
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect
from support.chromium import PHONE, SIZES, TABLET, WITHOUT_DRAWING, OpenPage, save_screenshot
from support.consoles import PlainScreen, live_socket, running_console
from support.sessions import HandSession, driven, driving

from guidance_app.console.server import Console
from guidance_app.documents import Settings
from guidance_app.model import LinkState, LinkStatus, Snapshot, TurnGuide

pytestmark = pytest.mark.browser

MILLIMETRE = 1e-3
LEAST_DIGIT_PX = 40
Make = Callable[[float, int], Snapshot]


def driving_on(now: float, sequence: int) -> Snapshot:
    """Along the line."""
    return driving(at=now, sequence=sequence)


class Drive:
    """A running console and the hand that writes its snapshots; ``make`` may be replaced while it runs."""

    def __init__(self, console: Console, session: HandSession) -> None:
        self.console = console
        self.session = session
        self.asked: list[str] = []
        self.make: Make = driving_on

    def next(self, now: float, sequence: int) -> Snapshot:
        return self.make(now, sequence)

    @property
    def address(self) -> str:
        return self.console.addresses[0]


@pytest.fixture(scope="module")
def drive() -> Iterator[Drive]:
    """One console for all tests here, driven at 10 Hz."""
    session = HandSession()
    with running_console(session) as console:
        running = Drive(console, session)
        with driven(session, running.next):
            yield running


@pytest.fixture(scope="module")
def shared_page(drive: Drive, open_shared_page: OpenPage) -> Page:
    """The one page that most tests look at; an error in its log fails the module."""
    page = open_shared_page("about:blank", script=WITHOUT_DRAWING)
    page.on("request", lambda request: drive.asked.append(request.url))
    page.on("websocket", lambda socket: drive.asked.append(socket.url))
    page.goto(drive.address)
    return page


@pytest.fixture
def page(drive: Drive, shared_page: Page) -> Page:
    """The shared page as it is at the beginning: a tablet whose tractor drives along its line."""
    drive.make = driving_on
    shared_page.set_viewport_size({"width": TABLET[0], "height": TABLET[1]})
    in_state(shared_page, "guide")
    return shared_page


def in_state(page: Page, state: str) -> None:
    expect(page.locator("#lightbar")).to_have_attribute("data-state", state)


def drawn(page: Page) -> dict[str, Any]:
    return dict(page.evaluate("window.__lightbar.drawn"))


def off_by(off: float, now: float, sequence: int) -> Snapshot:
    return driving(off, at=now, sequence=sequence)


# --- what is drawn -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", SIZES)
def test_the_bar_stands_over_the_whole_width_and_viser_below_it(
    drive: Drive, page: Page, size: tuple[int, int]
) -> None:
    drive.make = lambda now, sequence: driving(
        0.43, at=now, sequence=sequence, predicted=0.21, turn=TurnGuide(42.0, 8.0, np.zeros((2, 2)))
    )
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.wait_for_selector("#root canvas")
    expect(page.locator("#lightbar .turn")).to_have_text("end in 42 m · 8 s")
    bar, canvas = page.locator("#lightbar").bounding_box(), page.locator("#lightbar canvas").bounding_box()
    root = page.locator("#root").bounding_box()
    assert bar is not None
    assert canvas is not None
    assert root is not None
    assert (bar["x"], bar["y"], bar["width"]) == (0, 0, size[0])
    assert canvas["width"] == size[0]
    assert root["y"] == bar["height"]
    assert root["y"] + root["height"] == size[1]
    assert bar["height"] < size[1] / 4
    for line in page.locator("#lightbar .side > div").all():
        assert line.evaluate("line => line.scrollWidth <= line.clientWidth"), line.inner_text()
    save_screenshot(page, f"bar-{size[0]}x{size[1]}")


@pytest.mark.parametrize(
    ("off", "lamps", "number", "steer"),
    [
        (0.124, -3, "12 cm", "left"),
        (-0.31, 5, "31 cm", "right"),
        (0.012, 0, "1 cm", "left"),
        (0.0, 0, "0 cm", "none"),
        (-4.2, 8, "4.20 m", "right"),
    ],
)
def test_the_number_in_the_page_is_the_number_sent(
    drive: Drive, page: Page, off: float, lamps: int, number: str, steer: str
) -> None:
    drive.make = lambda now, sequence: driving(off, at=now, sequence=sequence)
    bar = page.locator("#lightbar")
    expect(bar).to_have_attribute("data-cross-track", f"{off:.3f}")
    expect(bar).to_have_attribute("data-lamps", str(lamps))
    shown = drawn(page)
    assert (shown["lamps"], shown["number"], shown["steer"]) == (lamps, number, steer)
    label = bar.locator("canvas").get_attribute("aria-label")
    assert label == ("on the line" if steer == "none" else f"steer {steer} {number}")


PICTURE = """() => {
  const shown = document.querySelector('#lightbar canvas'), copy = document.createElement('canvas');
  [copy.width, copy.height] = [shown.width, shown.height];
  const pen = copy.getContext('2d');
  pen.drawImage(shown, 0, 0);
  return pen;
}"""
"""What stands on the canvas, to be read: the canvas itself belongs to its worker."""

LIT = f"""([name, left, right]) => {{
  const pen = ({PICTURE})(), probe = document.createElement('canvas').getContext('2d');
  probe.fillStyle = getComputedStyle(document.getElementById('lightbar')).getPropertyValue(name).trim();
  probe.fillRect(0, 0, 1, 1);
  const [r, g, b] = probe.getImageData(0, 0, 1, 1).data;
  const middle = pen.canvas.width / 2;
  const has = (from) => {{
    const {{ data }} = pen.getImageData(from, 10, middle - 140, 74);
    let hits = 0;
    for (let i = 0; i < data.length; i += 4)
      if (data[i] === r && data[i + 1] === g && data[i + 2] === b) hits += 1;
    return hits > 0.005 * (data.length / 4);
  }};
  return has(0) === left && has(middle + 140) === right;
}}"""
"""Whether the lamps' row shows a colour in its left and in its right half, as asked."""


def expect_lit(page: Page, colour: str, *, left: bool, right: bool) -> None:
    page.wait_for_function(LIT, arg=[colour, left, right])


@pytest.mark.parametrize(("off", "colour"), [(0.08, "--green"), (0.4, "--yellow"), (1.5, "--red")])
def test_lamps_are_lit_on_the_side_to_steer_to(drive: Drive, page: Page, off: float, colour: str) -> None:
    for sign in (1, -1):
        drive.make = functools.partial(off_by, sign * off)
        expect(page.locator("#lightbar")).to_have_attribute("data-cross-track", f"{sign * off:.3f}")
        expect_lit(page, colour, left=sign > 0, right=sign < 0)


def test_the_number_is_readable_at_arms_length(drive: Drive, page: Page) -> None:
    drive.make = lambda now, sequence: driving(-0.88, at=now, sequence=sequence)
    expect(page.locator("#lightbar")).to_have_attribute("data-number", "88 cm")
    page.wait_for_function(
        f"""least => {{
          const pen = ({PICTURE})(), from = pen.canvas.width / 2 - 60, {{ data }} = pen.getImageData(from, 26, 60, 58);
          const dark = (x, y) => data[4 * (60 * y + x)] < 60 && data[4 * (60 * y + x) + 3] > 200;
          const rows = [...Array(58).keys()].filter((y) => [...Array(60).keys()].some((x) => dark(x, y)));
          return rows.at(-1) - rows[0] + 1 >= least;
        }}""",
        arg=LEAST_DIGIT_PX,
    )


def test_the_words_at_the_sides(drive: Drive, page: Page) -> None:
    bar = page.locator("#lightbar")
    expect(bar.locator(".pass")).to_have_text("pass 3 of 24 (line +2)")
    expect(bar.locator(".turn")).to_have_text("end in 500 m")
    expect(bar.locator(".work")).to_have_text("working")
    expect(bar.locator(".speed")).to_have_text("8.3km/h")
    expect(bar.locator(".fix")).to_have_text("RTK fixed, <1 s")
    expect(bar.locator(".area")).to_have_text("3.42 ha")
    expect(bar.locator(".guided")).to_have_text("tractor")


@pytest.mark.parametrize(("seconds", "level"), [(30.0, "far"), (8.0, "soon"), (2.0, "now")])
def test_the_turn_changes_its_colour(drive: Drive, page: Page, seconds: float, level: str) -> None:
    turn = TurnGuide(2.3 * seconds, seconds, np.zeros((2, 2)))
    drive.make = lambda now, sequence: driving(at=now, sequence=sequence, turn=turn)
    expect(page.locator("#lightbar .turn")).to_have_attribute("data-level", level)


def test_the_prediction_stands_where_the_tractor_is_heading(drive: Drive, page: Page) -> None:
    drive.make = lambda now, sequence: driving(0.3, at=now, sequence=sequence, predicted=-0.2)
    expect(page.locator("#lightbar")).to_have_attribute("data-cross-track", "0.300")
    shown = drawn(page)
    assert shown["steer"] == "left"
    assert shown["prediction"] == pytest.approx(-0.5, abs=MILLIMETRE)


# --- nothing to steer by -------------------------------------------------------------------------------------------


def heading_unknown(now: float, sequence: int) -> Snapshot:
    snapshot = driving(at=now, sequence=sequence)
    assert snapshot.pose is not None
    return replace(snapshot, pose=replace(snapshot.pose, heading_known=False))


BLANKS: dict[str, tuple[Make, str, str]] = {
    "no-fix": (lambda now, s: replace(driving(at=now, sequence=s), link=LinkState(LinkStatus.NO_FIX)), "No fix", ""),
    "stale": (lambda now, s: driving(at=now - 7, sequence=s), "No position for 7 s", ""),
    "no-line": (lambda now, s: replace(driving(at=now, sequence=s), guidance=None), "No line", "8.3"),
    "not-ready": (lambda now, s: replace(driving(at=now, sequence=s), pose=None), "Finding the position", ""),
    "no-direction": (heading_unknown, "Direction unknown: drive 2 m", "8.3"),
}


@pytest.mark.parametrize("size", [TABLET, PHONE])
def test_without_a_value_the_bar_is_hollow_and_says_why(drive: Drive, page: Page, size: tuple[int, int]) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    in_state(page, "guide")
    bar = page.locator("#lightbar")
    for state, (make, reason, speed) in BLANKS.items():
        drive.make = make
        in_state(page, state)
        shown = drawn(page)
        assert (shown["reason"], shown["number"], shown["lamps"], shown["prediction"]) == (reason, None, None, None)
        assert bar.get_attribute("data-cross-track") == ""
        expect(bar.locator(".pass")).to_have_text("")
        expect(bar.locator(".speed .number")).to_have_text(speed)
        if size == TABLET:
            for colour in ("--green", "--yellow", "--red"):
                expect_lit(page, colour, left=False, right=False)
        save_screenshot(page, f"bar-{state}-{size[0]}x{size[1]}")


def test_a_raised_implement_is_hollow_and_the_guidance_goes_on(drive: Drive, page: Page) -> None:
    drive.make = lambda now, sequence: driving(at=now, sequence=sequence, working=False)
    expect(page.locator("#lightbar .work")).to_have_text("implement up")
    in_state(page, "guide")


# --- day, night, sound, sleep --------------------------------------------------------------------------------------


def test_the_bar_follows_visers_day_and_night(drive: Drive, page: Page) -> None:
    bar = page.locator("#lightbar")
    gui = PlainScreen.newest.server.gui
    expect(bar).to_have_attribute("data-palette", "day")
    try:
        gui.configure_theme(dark_mode=True)
        expect(bar).to_have_attribute("data-palette", "night")
        expect(bar).to_have_css("background-color", "rgb(11, 16, 20)")
        save_screenshot(page, "bar-night")
    finally:
        gui.configure_theme(dark_mode=False)
    expect(bar).to_have_attribute("data-palette", "day")


def test_sound_begins_with_the_first_tap(page: Page) -> None:
    assert page.evaluate("__page.beep(440, 30)") is False
    page.mouse.click(20, 20)
    page.wait_for_function("__page.beep(440, 30)")


def going_across(now: float, sequence: int) -> Snapshot:
    """Along the headland, away from a line that no plan asks for."""
    snapshot = driving(4.0, at=now, sequence=sequence, working=False)
    assert snapshot.guidance is not None
    target = replace(snapshot.guidance.target, order=None)
    turned = replace(snapshot.guidance, target=target, heading_error=math.radians(80), on_pass=False)
    return replace(snapshot, guidance=turned)


def test_a_lost_link_is_heard_and_going_across_the_lines_is_not(open_page: OpenPage) -> None:
    session = HandSession(Settings(sounds=True))
    with running_console(session) as console:
        drive = Drive(console, session)
        with driven(session, drive.next):
            page = open_page(drive.address, script=WITHOUT_DRAWING)
            in_state(page, "guide")
            page.evaluate("() => { window.beeps = []; __page.beep = (...tone) => window.beeps.push(tone); }")
            drive.make = going_across
            in_state(page, "across")
            drive.make = driving_on
            in_state(page, "guide")
            assert page.evaluate("window.beeps") == []
            drive.make = going_across
            in_state(page, "across")
            drive.make = lambda now, sequence: replace(driving_on(now, sequence), link=LinkState(LinkStatus.DOWN))
            page.wait_for_function("window.beeps.length === 2")


def test_the_page_counts_as_focused_while_it_is_seen(drive: Drive, page: Page) -> None:
    in_state(page, "guide")
    assert page.evaluate("document.hasFocus()") is True
    assert page.title() == "Guidance"


def test_nothing_is_fetched_from_elsewhere(drive: Drive, page: Page) -> None:
    page.wait_for_selector("#root canvas")
    own = re.compile(rf"(http|ws)://{drive.address.removeprefix('http://')}/|blob:|data:")
    assert len(drive.asked) > 5
    assert [url for url in drive.asked if not own.match(url)] == []


# --- in a worker ---------------------------------------------------------------------------------------------------

BUSY_MS = 1500
LONGEST_GAP_MS = 700.0
"""Half of the time for which the page is busy: whoever waits for the page misses all of it."""


def test_the_bar_is_drawn_while_the_page_is_busy(page: Page) -> None:
    assert page.evaluate("window.__lightbar.worker") is True
    begun, ended = page.evaluate(
        f"""() => {{
          const begun = Date.now();
          while (Date.now() - begun < {BUSY_MS});
          return [begun, Date.now()];
        }}"""
    )
    page.wait_for_function(f"window.__lightbar.timings.at(-1).drawn > {ended}")
    drawn_at = [timing["drawn"] for timing in page.evaluate("window.__lightbar.timings")]
    during = [begun, *(moment for moment in drawn_at if begun < moment < ended), ended]
    assert max(after - before for before, after in itertools.pairwise(during)) < LONGEST_GAP_MS


def test_a_browser_that_cannot_draw_from_a_worker_draws_on_the_page(drive: Drive, open_page: OpenPage) -> None:
    drive.make = functools.partial(off_by, -0.4)
    older = f"{WITHOUT_DRAWING}; delete HTMLCanvasElement.prototype.transferControlToOffscreen;"
    page = open_page(drive.address, script=older)
    expect(page.locator("#lightbar")).to_have_attribute("data-cross-track", "-0.400")
    assert page.evaluate("window.__lightbar.worker") is False
    expect_lit(page, "--yellow", left=False, right=True)


# --- with others ---------------------------------------------------------------------------------------------------


def test_every_fix_reaches_the_page_in_order_beside_two_more_clients(drive: Drive, page: Page) -> None:
    with live_socket(drive.console), live_socket(drive.console):
        page.evaluate("window.__lightbar.timings.length = 0")
        page.wait_for_function("new Set(window.__lightbar.timings.map((timing) => timing.sequence)).size > 20")
        drawn = page.evaluate("window.__lightbar.timings.map((timing) => timing.sequence)")
    assert drawn == sorted(drawn)
