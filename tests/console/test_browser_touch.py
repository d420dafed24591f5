"""Fingers and mouse on viser's page: taps arrive, swipes do not count, panels stay where they are."""

import threading

import pytest
from playwright.sync_api import CDPSession
from support.chromium import WITHOUT_DRAWING, OpenPage
from support.consoles import PlainScreen, StartConsole

pytestmark = pytest.mark.browser


class TappedScreen(PlainScreen):
    """Hears taps on the ground."""

    tapped = threading.Event()

    def start(self) -> None:
        super().start()
        self.server.gui.main_panel.dock_right()
        self.server.scene.add_box("/box", dimensions=(1, 1, 1))
        self.server.scene.on_click()(lambda _: TappedScreen.tapped.set())


def touch(session: CDPSession, kind: str, *points: tuple[float, float]) -> None:
    session.send(
        "Input.dispatchTouchEvent",
        {"type": kind, "touchPoints": [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)]},
    )


def test_taps_arrive_swipes_do_not_and_panels_stay(start_console: StartConsole, open_page: OpenPage) -> None:
    console = start_console(screen_factory=TappedScreen)
    page = open_page(console.addresses[0], touch=True, script=WITHOUT_DRAWING)
    page.wait_for_selector("#root canvas")
    page.wait_for_function("window.__viserMutable?.nodeRefFromName?.['/box']")
    assert PlainScreen.newest.came.wait(20)
    finger = page.context.new_cdp_session(page)
    assert tapped(finger, wobble=0.0, tries=10)
    assert tapped(finger, wobble=9.0, tries=3)
    assert not tapped(finger, wobble=40.0, tries=2)
    head = page.locator("[data-dock-header]").first
    before = head.bounding_box()
    assert before is not None
    x, y = before["x"] + 60, before["y"] + 20
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 300, y + 200, steps=8)
    page.mouse.up()
    assert head.bounding_box() == before


def tapped(finger: CDPSession, wobble: float, tries: int) -> bool:
    """Whether the server hears of a finger that comes down, wanders so many pixels and goes up again."""
    TappedScreen.tapped.clear()
    for _ in range(tries):
        touch(finger, "touchStart", (300.0, 500.0))
        for part in (0.3, 0.6, 1.0):
            touch(finger, "touchMove", (300.0 + part * wobble, 500.0))
        touch(finger, "touchEnd")
        if TappedScreen.tapped.wait(0.7):
            return True
    return False
