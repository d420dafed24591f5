"""The real command in a real browser: ``guidance-app demo`` opened, wound to a second, turned, frozen and thawed.

The light bar's number is compared with that of an engine of its own, which takes the same recording to the same second.
"""

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect
from support.chromium import SIZES, TABLET, WITHOUT_DRAWING, OpenPage, assert_silent_at_the_first_look, save_screenshot

from guidance_app.commands.demo import SAMPLE_OPERATION
from guidance_app.documents import Job
from guidance_app.engine import Engine
from guidance_app.model import SourceUp
from guidance_app.sources.file import FileLog, load_log
from guidance_app.store import SAMPLE_RECORDING, Store, copy_sample, load_job
from guidance_app.view.bar import BarView, bar_of

pytestmark = pytest.mark.browser

MILLIMETRE = 1e-3
END_S = 60.0
IN_THE_MIDDLE, NEAR_THE_START = 0.42, 0.18
"""Where the slider is tapped, as a part of its length: in the middle of a pass, also some seconds beside it."""

SCENE = "window.__viserMutable?.nodeRefFromName?.['/w/here/tractor']"
PICTURES = """async (count) => {
    for (let k = 0; k < count; k++) await new Promise(requestAnimationFrame);
}"""
CAMERA = "window.__viserMutable.camera.position.length()"
LOST = (r"ERR_CONNECTION_REFUSED", r"ERR_CONNECTION_RESET", r"ERR_EMPTY_RESPONSE", r"WebSocket")
"""What a browser writes into its log while nobody answers; nothing else may stand there."""


class Demo:
    """The running command and the address that it has printed."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "guidance_app", "demo", "--port", "0"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._process.stdout is not None
        self.printed = ""
        for line in self._process.stdout:
            self.printed += line
            if "Ctrl-C" in line:
                break
        found = re.search(r"http://127\.0\.0\.1:\d+", self.printed)
        assert found is not None, f"no address was printed: {self.printed!r}"
        self.address = found[0]

    def freeze(self) -> None:
        self._process.send_signal(signal.SIGSTOP)

    def thaw(self) -> None:
        self._process.send_signal(signal.SIGCONT)

    def end(self) -> int:
        """Ends it as a person does; its exit status."""
        self.thaw()
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.communicate(timeout=END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()
            raise
        return self._process.returncode


@dataclass(frozen=True, slots=True)
class Sample:
    """What the command plays."""

    job: Job
    log: FileLog

    def bar_at(self, second: float) -> BarView:
        """What the light bar has to say at this second: an engine of its own takes the recording up to there."""
        engine = Engine(self.job)
        engine.step(SourceUp(0.0, self.log.description))
        for chunk in self.log.chunks:
            if chunk.arrival > second:
                break
            engine.step(chunk)
        return bar_of(engine.snapshot, second, self.job.settings)


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> Sample:
    data = copy_sample(tmp_path_factory.mktemp("sample"))
    return Sample(load_job(Store(data), SAMPLE_OPERATION), load_log(data / SAMPLE_RECORDING / "receiver.nmea"))


@pytest.fixture(scope="module")
def demo() -> Iterator[Demo]:
    """One run of the command for all tests here; it has to end in good order."""
    running = Demo()
    try:
        yield running
    finally:
        status = running.end()
    assert status == 0


def opened(demo: Demo, open_page: OpenPage, size: tuple[int, int] = TABLET, script: str = "") -> Page:
    """The page, once the scene is there and viser's remark about software drawing is away."""
    page = open_page(demo.address, size=size, touch=True, script=script, allow=LOST)
    page.wait_for_function(SCENE)
    page.add_style_tag(content=".mantine-Notifications-root{display:none}")
    return page


@pytest.fixture(scope="module")
def page(demo: Demo, open_shared_page: OpenPage) -> Page:
    """The one page of the tests that need no picture; an error in its log fails the module."""
    return opened(demo, open_shared_page, script=WITHOUT_DRAWING)


def slider(page: Page) -> Locator:
    return page.locator(".mantine-Slider-root:visible").first


def wind_to(page: Page, part: float) -> int:
    """Taps the replay's slider at a part of its length and waits until it stands there; the second."""
    box = slider(page).bounding_box()
    assert box is not None
    slider(page).tap(position={"x": part * box["width"], "y": box["height"] / 2})
    thumb = slider(page).get_by_role("slider")
    page.wait_for_function(
        """([thumb, part]) => {
            const [now, end] = ["aria-valuenow", "aria-valuemax"].map((name) => Number(thumb.getAttribute(name)));
            return Math.abs(now / end - part) < 0.05;
        }""",
        arg=[thumb.element_handle(), part],
    )
    return int(thumb.get_attribute("aria-valuenow") or "")


def hold(page: Page) -> None:
    """Pauses the recording, if it plays."""
    page.get_by_text("Replay", exact=True).tap()
    button = page.get_by_role("button", name=re.compile("^(Pause|Play)$"))
    expect(button).to_be_visible()
    if button.inner_text() == "Pause":
        button.tap()
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()


def test_the_page_shows_the_engines_number_at_every_second_it_is_wound_to(page: Page, sample: Sample) -> None:
    hold(page)
    bar = page.locator("#lightbar")
    for part in (IN_THE_MIDDLE, NEAR_THE_START):
        second = wind_to(page, part)
        expected = sample.bar_at(second)
        assert expected.steering is not None, f"nothing to compare at {second} s; choose another place"
        expect(bar).to_have_attribute("data-cross-track", f"{round(expected.steering.cross_track * 1000) / 1000:.3f}")
        assert float(bar.get_attribute("data-cross-track") or "nan") == pytest.approx(
            expected.steering.cross_track, abs=MILLIMETRE
        )
        expect(bar).to_have_attribute("data-number", expected.steering.number)
        expect(bar).to_have_attribute("data-lamps", str(expected.steering.lamps))
        expect(bar.locator(".pass")).to_have_text(expected.steering.pass_text)
        expect(bar.locator(".area")).to_have_text(expected.area)


def test_a_finger_changes_the_view_and_plays_on(page: Page) -> None:
    hold(page)
    wind_to(page, IN_THE_MIDDLE)
    near = page.evaluate(CAMERA)
    page.get_by_text("Views", exact=True).tap()
    page.get_by_role("button", name="Whole field").tap()
    page.wait_for_function(f"(near) => {CAMERA} > 2 * near", arg=near)
    page.get_by_role("button", name="Driver").tap()
    page.wait_for_function(f"(near) => Math.abs({CAMERA} - near) < 1", arg=near)
    page.get_by_text("Replay", exact=True).tap()
    stood = page.evaluate("window.__lightbar.message.q")
    page.get_by_role("button", name="Play", exact=True).tap()
    page.wait_for_function("(stood) => window.__lightbar.message?.q > stood + 5", arg=stood)


def test_a_frozen_command_says_no_data_within_a_second_and_both_bar_and_scene_come_back(demo: Demo, page: Page) -> None:
    hold(page)
    wind_to(page, NEAR_THE_START)
    page.get_by_role("button", name="Play", exact=True).tap()
    bar = page.locator("#lightbar")
    expect(bar).to_have_attribute("data-state", "guide")
    demo.freeze()
    try:
        expect(bar).to_have_attribute("data-state", "silent")
        assert_silent_at_the_first_look(page)
        assert bar.get_attribute("data-cross-track") == ""
        expect(bar.locator("canvas")).to_have_attribute("aria-label", "NO DATA")
    finally:
        demo.thaw()
    expect(bar).to_have_attribute("data-state", "guide")
    page.wait_for_function(SCENE)
    world = "window.__viserMutable.nodeRefFromName['/w'].position.toArray()"
    stood = page.evaluate(world)
    page.wait_for_function(f"(stood) => Math.hypot(...{world}.map((v, k) => v - stood[k])) > 1", arg=stood)


def test_the_job_half_done_is_drawn_at_three_sizes(demo: Demo, page: Page, open_page: OpenPage, tmp_path: Path) -> None:
    """The first page has the wheel and holds the recording; those of the three sizes follow."""
    hold(page)
    second = wind_to(page, IN_THE_MIDDLE)
    for size in SIZES:
        sized = opened(demo, open_page, size=size)
        if sized.get_by_text("Replay", exact=True).is_hidden():
            sized.get_by_text(re.compile("^Work · ")).tap()
        sized.get_by_text("Replay", exact=True).tap()
        expect(slider(sized).get_by_role("slider")).to_have_attribute("aria-valuenow", str(second))
        sized.evaluate(PICTURES, 5)
        picture = sized.screenshot(path=tmp_path / f"demo-{size[0]}x{size[1]}.png")
        assert len(picture) > 20_000, "a picture of a field in work is not so plain"
        save_screenshot(sized, f"demo-{size[0]}x{size[1]}")
        sized.close()
