"""A real browser for a measurement: the machine's own Chromium, driven by Playwright. Nothing is downloaded.

``Browser`` opens one page of the console. The 3D draw calls are taken out by default: without a graphics card they are
done by the processor, and what is then measured is that. All else of the page runs as it is.
"""

import os
import shutil
from types import TracebackType
from typing import Any, Self

from guidance_app.bench.errors import BenchError

__all__ = ["WITHOUT_DRAWING", "Browser", "chromium_path"]

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
)
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
TABLET = {"width": 1280, "height": 800}
PATIENCE_MS = 60_000.0

WITHOUT_DRAWING = """
for (const kind of [self.WebGLRenderingContext, self.WebGL2RenderingContext]) {
  for (const call of ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"]) {
    if (kind && call in kind.prototype) kind.prototype[call] = () => {};
  }
}
"""


def chromium_path() -> str:
    """Where this machine's Chromium is; ``GUIDANCE_CHROMIUM`` names another one. Raises ``BenchError`` without one."""
    named = os.environ.get("GUIDANCE_CHROMIUM")
    found = next((path for name in ((named,) if named else NAMES) if (path := shutil.which(name))), None)
    if found is None:
        looked = named or ", ".join(NAMES)
        msg = f"no Chromium was found on this machine ({looked}): install it, or name its program in GUIDANCE_CHROMIUM."
        raise BenchError(msg)
    return found


class Browser:
    """One page in a browser of its own, for the length of a ``with``. Raises ``BenchError`` when there is none."""

    def __init__(self, address: str, script: str = WITHOUT_DRAWING) -> None:
        self._address = address
        self._script = script

    def __enter__(self) -> Self:
        path = chromium_path()
        try:
            from playwright.sync_api import Error, sync_playwright  # noqa: PLC0415 - only this bench needs it
        except ImportError as error:
            msg = "the browser is driven by Playwright, which is not installed: pip install 'guidance-app[test]'."
            raise BenchError(msg) from error
        self._error = Error
        self._playwright = sync_playwright().start()
        try:
            self._browser = self._playwright.chromium.launch(executable_path=path, headless=True, args=list(FLAGS))
            context = self._browser.new_context(viewport=TABLET)  # type: ignore[arg-type]  # a dict of two lengths
            context.set_default_timeout(PATIENCE_MS)
            context.add_init_script(self._script)
            self._page = context.new_page()
            self._page.goto(self._address, wait_until="domcontentloaded")
        except Error as error:
            self._playwright.stop()
            msg = f"{path} did not open the console's page: {error.message.splitlines()[0]}"
            raise BenchError(msg) from error
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._browser.close()
        self._playwright.stop()

    def until(self, condition: str) -> None:
        """Waits until the page finds ``condition`` true. Raises ``BenchError``."""
        try:
            self._page.wait_for_function(condition)
        except self._error as error:
            msg = f"the page did not come to {condition} within {PATIENCE_MS / 1000:g} s."
            raise BenchError(msg) from error

    def value_of(self, expression: str) -> Any:
        """What the page makes of ``expression``."""
        return self._page.evaluate(expression)

    def wait(self, seconds: float) -> None:
        """Lets the page run."""
        self._page.wait_for_timeout(seconds * 1000.0)
