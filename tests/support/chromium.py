"""A real Chromium for tests, driven by Playwright: pages that fail their test when their log holds an error.

The browser is the machine's own (``GUIDANCE_CHROMIUM`` names another one); nothing is downloaded. It draws in software,
so what a test measures in it is the page's work, not a graphics card's.

Playwright's synchronous interface keeps an event loop on the test's thread while it runs. The browser therefore lives
for one test module, and such a module cannot call ``asyncio.run`` itself.
"""

import contextlib
import os
import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, expect, sync_playwright

TABLET = (1280, 800)
SMALL_TABLET = (1024, 768)
PHONE = (390, 844)
SIZES = (TABLET, SMALL_TABLET, PHONE)

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--force-color-profile=srgb",
)

WITHOUT_DRAWING = """
for (const kind of [self.WebGLRenderingContext, self.WebGL2RenderingContext]) {
  for (const call of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced']) {
    if (kind && call in kind.prototype) kind.prototype[call] = () => {};
  }
}
"""
"""A script for ``open_page``: all runs but the 3D draw calls, whose cost without a graphics card hides all else."""

OpenPage = Callable[..., Page]

PATIENCE_MS = 60_000
SILENT_WITHIN_MS = 1000.0
ROUNDING_MS = 0.01
expect.set_options(timeout=PATIENCE_MS)


def chromium_path() -> str | None:
    """Where this machine's Chromium is; None without one."""
    named = os.environ.get("GUIDANCE_CHROMIUM")
    names = [named] if named else ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]
    return next((found for name in names if (found := shutil.which(name))), None)


class PageLog:
    """What a page said that it should not have said: uncaught exceptions, rejected promises, lines of level error."""

    def __init__(self, page: Page, allowed: Sequence[str]) -> None:
        self.errors: list[str] = []
        self._allowed = [re.compile(pattern) for pattern in allowed]
        page.on("pageerror", lambda error: self._note(f"uncaught: {error}"))
        page.on("console", self._hear)
        page.on("crash", lambda _: self._note("the page crashed"))

    def _hear(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self._note(f"{message.text} ({message.location.get('url', '')})")

    def _note(self, error: str) -> None:
        if not any(pattern.search(error) for pattern in self._allowed):
            self.errors.append(error)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    """One browser for the tests of a module."""
    path = chromium_path()
    if path is None:
        if os.environ.get("GUIDANCE_ALL_TESTS"):
            pytest.fail("no Chromium on this machine, and GUIDANCE_ALL_TESTS forbids skipping")
        pytest.skip("no Chromium on this machine")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, headless=True, args=list(FLAGS))
        yield browser
        browser.close()


@pytest.fixture
def open_page(chromium: Browser) -> Iterator[OpenPage]:
    """Opens an address in a page of its own: ``open_page(url, size=TABLET, touch=False, allow=(), script="")``.

    ``allow`` are patterns of log lines that the test expects, ``script`` runs before the page's own. Further arguments
    go to the browser context. After the test every page is closed, and any other error in a page's log fails it.
    """
    with clean_pages(chromium) as open_one:
        yield open_one


@pytest.fixture(scope="module")
def open_shared_page(chromium: Browser) -> Iterator[OpenPage]:
    """The same for a page that serves all tests of a module: opening viser's page costs a second."""
    with clean_pages(chromium) as open_one:
        yield open_one


@contextlib.contextmanager
def clean_pages(chromium: Browser) -> Iterator[OpenPage]:
    """Opens pages, closes them at the end, and asserts then that their logs are clean."""
    contexts: list[BrowserContext] = []
    logs: list[PageLog] = []

    def open_one(
        url: str,
        *,
        size: tuple[int, int] = TABLET,
        touch: bool = False,
        allow: Sequence[str] = (),
        script: str = "",
        **context_options: Any,
    ) -> Page:
        context = chromium.new_context(
            viewport={"width": size[0], "height": size[1]}, has_touch=touch, **context_options
        )
        contexts.append(context)
        context.set_default_timeout(PATIENCE_MS)
        if script:
            context.add_init_script(script)
        page = context.new_page()
        logs.append(PageLog(page, allow))
        page.goto(url, wait_until="domcontentloaded")
        return page

    try:
        yield open_one
    finally:
        for context in contexts:
            context.close()
    errors = [error for log in logs for error in log.errors]
    assert not errors, "the page's log holds errors:\n" + "\n".join(errors)


def assert_silent_at_the_first_look(page: Page) -> None:
    """Silence is said within a second, as far as it is up to the page: by the first look that could find it.

    How late a busy machine lets the page look is not asked.
    """
    names = ("lastHeard", "lookedBefore", "silentAfter", "lookEvery")
    heard, before, limit, every = (page.evaluate(f"window.__lightbar.{name}") for name in names)
    assert limit + every < SILENT_WITHIN_MS
    assert before - heard <= limit + ROUNDING_MS


def save_screenshot(page: Page, name: str) -> None:
    """Keeps a picture of the page as ``NAME.png`` in the folder that ``GUIDANCE_SCREENSHOTS`` names, if any."""
    folder = os.environ.get("GUIDANCE_SCREENSHOTS")
    if folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
        page.screenshot(path=Path(folder) / f"{name}.png")
