"""The recordings panel: what was driven, to look at, to replay, to compare and to hand in."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

import viser

from guidance_app.batch.reviewing import Review, opened_review
from guidance_app.batch.taking_in import taken_in
from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.pages import MakePage, Page, Pages, press
from guidance_app.console.reviewing.listing import ListWays, RecordingList
from guidance_app.console.reviewing.looking import Looking, Ways
from guidance_app.console.reviewing.several import LedgerOfSeveral
from guidance_app.console.widgets import Shown, notice_html
from guidance_app.language import message
from guidance_app.runtime import ReplaySession, cache_folder
from guidance_app.store import Removed, StoreError
from guidance_app.store.recordings import open_recording
from guidance_app.store.recordings_keeping import bring_back, remove_recording
from guidance_app.store.recordings_list import ListedRecording, list_recordings

__all__ = ["Recordings"]

NOBODY = 0


class Recordings:
    """One page at a time: the list, the progress of an opening, one recording."""

    title: ClassVar[str] = message("Recordings")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._pages = Pages(gui, hands)
        self._removed: Removed | None = None
        self._asked = 0
        """Counts the pages that were asked for: what is read for one comes too late once another is wished for."""
        self._go_to(0)

    def show(self, desk: Desk) -> None:
        """Brings the open page up to now."""
        self._pages.show(desk)

    def _go_to(self, page: int, said: tuple[str, ...] = ()) -> None:
        undo = None if self._removed is None else self._undo
        ways = ListWays(self._look, self._go_to, self._ledger, self._take, undo)

        def listed(found: tuple[ListedRecording, ...]) -> MakePage:
            return lambda gui: RecordingList(gui, self._hands, found, page, ways, said)

        self._turn_with(listed)

    def _turn_with(self, made: Callable[[tuple[ListedRecording, ...]], MakePage]) -> None:
        """Another page once the recordings have been looked through, which takes a moment where there are many."""
        self._asked += 1
        asked = self._asked

        def look() -> None:
            store = self._hands.house.store
            found = () if store is None else list_recordings(store.root)
            if asked == self._asked:
                self._pages.turn(made(found))

        self._hands.house.aside(look)

    # --- what comes, goes and comes back ---------------------------------------------------------------------------

    def _take(self, name: str, content: bytes) -> None:
        def keep() -> None:
            words = self._hands.words
            folders, told = taken_in(self._data, content, name)
            said = words.plural("{n} recording was taken in.", "{n} recordings were taken in.", len(folders))
            self._go_to(0, (said, *(words.say(one) for one in told)))

        self._hands.later(keep)

    def _delete(self, path: Path) -> None:
        def delete() -> None:
            self._removed = remove_recording(self._data, path)
            self._go_to(0, (self._hands.words("'{name}' is deleted.", name=path.name),))

        self._hands.later(delete)

    def _undo(self) -> None:
        def work() -> None:
            removed, self._removed = self._removed, None
            if removed is not None:
                bring_back(self._data, removed)
            self._go_to(0, (self._hands.words("It is back."),))

        self._hands.later(work)

    def _ledger(self) -> None:
        def ledger(found: tuple[ListedRecording, ...]) -> MakePage:
            return lambda gui: LedgerOfSeveral(gui, self._hands, self._data, found, lambda: self._go_to(0))

        self._turn_with(ledger)

    @property
    def _data(self) -> Path:
        store = self._hands.house.store
        assert store is not None, "without a store there are no recordings"
        return store.root

    # --- one of them -----------------------------------------------------------------------------------------------

    def _look(self, path: Path) -> None:
        self._asked += 1
        progress = _Progress(self._hands)
        self._pages.turn(progress.on)
        self._hands.later(lambda: self._open(path, progress))

    def _open(self, path: Path, progress: "_Progress") -> None:
        store = self._hands.house.store
        assert store is not None
        try:
            review = opened_review(path, store.root, progress.tell)
        except StoreError:
            self._go_to(0)
            raise
        self._turn_with(lambda found: lambda gui: self._looking(gui, path, review, found))

    def _looking(self, gui: viser.GuiApi, path: Path, review: Review, found: tuple[ListedRecording, ...]) -> Page:
        ways = Ways(lambda: self._go_to(0), lambda: self._replay(path))
        page = Looking(gui, self._hands, path, review, ways)
        paths = [one.path for one in found if one.summary is not None and one.path != path]
        if paths:
            self._offer_comparison(gui, page, paths)
        press(gui, self._hands.words("Delete this recording"), lambda: self._delete(path))
        return page

    def _offer_comparison(self, gui: viser.GuiApi, page: Looking, paths: list[Path]) -> None:
        words = self._hands.words
        names = (words("no other drive"), *(one.name for one in paths))
        which = gui.add_dropdown(words("Compare with"), names)

        def compare() -> None:
            place = names.index(which.value)
            store = self._hands.house.store
            chosen = None if place == NOBODY or store is None else opened_review(paths[place - 1], store.root)
            page.compare_with(chosen)

        @which.on_update
        async def _(_: object) -> None:
            self._hands.later(compare)

    def _replay(self, path: Path) -> None:
        def begin() -> None:
            if not self._hands.wheel.mine():
                return
            drive = open_recording(path)
            if not len(drive.events):
                msg = self._hands.words("This recording holds no event.")
                raise StoreError(msg)
            session = ReplaySession.of_drive(drive)
            session.make_index(cache_folder())
            self._hands.house.take(session)
            self._hands.go(Place.DRIVE)

        self._hands.later(begin)


class _Progress:
    """The page while a long recording is taken through the engine."""

    def __init__(self, hands: Hands) -> None:
        self._hands = hands
        self._done = 0.0

    def on(self, gui: viser.GuiApi) -> "_Progress":
        words = self._hands.words
        Shown(gui).show(notice_html([words("Working through the recording; the next time it opens at once.")]))
        self._bar: Any = gui.add_progress_bar(0.0, animated=True)
        return self

    def tell(self, done: float) -> None:
        """On the worker's thread."""
        self._done = done

    def show(self, desk: Desk) -> None:
        """Brings the bar up to what is done."""
        del desk
        self._bar.value = round(100.0 * self._done)
