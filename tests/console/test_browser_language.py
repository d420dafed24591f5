"""The console in Japanese and Spanish in a real browser: the bar and the panels say it, nothing is cut off."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from support.chromium import PHONE, SMALL_TABLET, TABLET, WITHOUT_DRAWING, OpenPage, save_screenshot
from support.consoles import running_console
from support.snapshots import SetSession, field_job, field_snapshot

from guidance_app.console.desk import Panel
from guidance_app.console.panels import PANELS, SETUP_PANELS
from guidance_app.console.screen import Screen
from guidance_app.language import Language, Words, words_for
from guidance_app.store import Store, copy_sample

pytestmark = pytest.mark.browser

CUT_OFF = """() => {
  const holders = ['.mantine-Button-label', '.g-tile i', '.g-tile b', '#lightbar .side > div'];
  const shown = [...document.querySelectorAll(holders)].filter((one) => one.checkVisibility() && one.clientWidth > 0);
  const wide = shown.filter((one) => one.scrollWidth > one.clientWidth + 1);
  return wide.map((one) => `${one.textContent} (${one.scrollWidth} in ${one.clientWidth})`);
}"""
"""The texts that are wider than what holds them."""


@contextmanager
def _console_in(language: Language, folder: Path) -> Iterator[str]:
    """A console that stands in the middle of a pass, for a driver who has chosen this language; its address."""
    job, store = field_job(), Store(copy_sample(folder))
    settings = job.settings.model_copy(update={"language": language})
    store.save(settings)
    session = SetSession(field_snapshot(), job.model_copy(update={"settings": settings}))
    with running_console(session, screen_factory=Screen, store=store) as console:
        yield console.addresses[0]


def _fits(page: Page, size: tuple[int, int]) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert page.evaluate(CUT_OFF) == []


def _each_fits(page: Page, words: Words, panels: Mapping[str, type[Panel]]) -> None:
    for name, panel in panels.items():
        page.get_by_role("tab", name=words(panel.title), exact=True).click()
        _fits(page, SMALL_TABLET)
        save_screenshot(page, f"language-{words.language}-{name}")


@pytest.mark.parametrize(
    ("language", "steer", "unit_of_time"), [("ja", "左へ切る", "秒"), ("es", "gire a la izquierda", "s")]
)
def test_the_whole_console_speaks_the_drivers_language(
    open_page: OpenPage, tmp_path: Path, language: Language, steer: str, unit_of_time: str
) -> None:
    words = words_for(language)
    with _console_in(language, tmp_path) as address:
        page = open_page(address, script=WITHOUT_DRAWING)
        bar = page.locator("#lightbar")
        expect(bar).to_have_attribute("data-state", "guide")
        expect(page.locator("html")).to_have_attribute("lang", language)
        expect(bar.locator("canvas")).to_have_attribute("aria-label", f"{steer} {bar.get_attribute('data-number')}")
        expect(bar.locator(".fix")).to_contain_text(unit_of_time)
        expect(page.get_by_role("button", name=words("Working · press to lift"))).to_be_visible()
        _fits(page, TABLET)
        # No recording is played, and with a plan no line is drawn.
        _each_fits(page, words, {name: panel for name, panel in PANELS.items() if name not in ("replay", "line")})
        page.get_by_role("button", name=words("Fields, machines, recordings")).click()
        _each_fits(page, words, SETUP_PANELS)
        _fits(page, PHONE)
