"""Files that leave through the page: a drive is stored under its name, and what cannot be made says why in its link."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from support.chromium import TABLET, WITHOUT_DRAWING, OpenPage
from support.consoles import running_console
from support.drives import a_job, path_chunks, up_and_down
from support.recordings import driven_live

from guidance_app.console.screen import Screen
from guidance_app.console.server import Console
from guidance_app.runtime import SessionManager
from guidance_app.store import Store

pytestmark = pytest.mark.browser


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """One recorded drive."""
    driven, _ = driven_live(tmp_path, path_chunks(up_and_down(passes=1)), a_job())
    return driven


@pytest.fixture
def console(tmp_path: Path, folder: Path) -> Iterator[Console]:
    """A console on it."""
    assert folder.is_dir()
    manager = SessionManager()
    manager.start()
    with running_console(manager, screen_factory=Screen, store=Store(tmp_path)) as running:
        yield running
    manager.close()


def looked_at(console: Console, open_page: OpenPage, *, allow: tuple[str, ...] = ()) -> Page:
    page = open_page(console.addresses[0], size=TABLET, touch=True, script=WITHOUT_DRAWING, allow=allow)
    page.get_by_role("tab", name="Recordings").tap()
    page.get_by_role("button", name="Look at").first.tap()
    expect(page.get_by_text("For other programs")).to_be_visible()
    page.get_by_text("For other programs").tap()
    return page


def test_a_drive_is_stored_as_gpx(console: Console, open_page: OpenPage, folder: Path) -> None:
    page = looked_at(console, open_page)
    link = page.get_by_text("GPX:")
    expect(link).to_be_visible()
    with page.expect_download() as coming:
        link.tap()
    stored = coming.value
    assert stored.suggested_filename == f"{folder.name}-gpx.gpx"
    assert stored.path().read_bytes().count(b"<trkpt") > 100
    expect(link.locator(".g-file-said")).to_have_count(0)


def test_a_file_that_cannot_be_made_says_why(console: Console, open_page: OpenPage, folder: Path) -> None:
    page = looked_at(console, open_page, allow=("409",))
    link = page.get_by_text("GPX:")
    expect(link).to_be_visible()
    folder.rename(folder.with_name("elsewhere"))
    link.tap()
    expect(link.locator(".g-file-said")).to_contain_text("there is no recording")
