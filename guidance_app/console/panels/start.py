"""The start panel: go on with a drive that was cut off, take a registered operation, or drive now with a width."""

import datetime
import html
from collections.abc import Mapping
from functools import partial
from typing import ClassVar

import viser
from pydantic import BaseModel, ConfigDict, Field

from guidance_app.console.beginnings import Beginnings, LastTime, OnField, beginnings_of
from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.forms import Form, heading_html
from guidance_app.console.pages import Pages, Still, press
from guidance_app.console.receiver_form import sources_found
from guidance_app.console.widgets import Shown, notice_html
from guidance_app.documents import Implement, Job, Receiver, Tractor, quantity
from guidance_app.language import Words, message
from guidance_app.store import StoreError, load_job
from guidance_app.store.recordings_list import Resumable, finish_recording

__all__ = ["Start", "cut_off_words"]

SIMULATED = "sim:"


class _DriveNow(BaseModel):
    """What a drive without a plan needs. Tractor and implement are names of registered ones, '' for none.

    ``receiver`` is an address.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    implement: str = Field("", title="Implement")
    working_width: float = quantity("Working width", "m", 0.3, 60, 3.0, when=("implement", ""))
    tractor: str = Field("", title="Tractor")
    receiver: str = Field(SIMULATED, title="Receiver")


def cut_off_words(found: Resumable, words: Words) -> str:
    """``6 of 24 passes done, 14:32``: how far a drive was, and when it was last heard of."""
    parts = [one for one in (found.field, found.operation) if one]
    if found.passes_done is not None and found.passes_planned is not None:
        parts.append(words("{done} of {count} passes done", done=found.passes_done, count=found.passes_planned))
    stopped = found.stopped_utc or found.started_utc
    try:
        moment = datetime.datetime.fromisoformat(stopped).astimezone()
    except ValueError:
        return ", ".join(parts)  # a summary that somebody has changed by hand: the rest still tells which drive it is
    return ", ".join([*parts, words.moment(moment)])


class Start:
    """Begins a drive. What it offers follows what is stored."""

    title: ClassVar[str] = message("Start")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._pages = Pages(gui, hands)
        self._version = -1
        self._shown: tuple[Beginnings | None, Mapping[str, str]] | None = None
        self._gathering = False

    def show(self, desk: Desk) -> None:
        """Looks again when something may have been stored."""
        version = self._hands.house.version
        if version != self._version and not self._gathering:
            self._version, self._gathering = version, True
            self._hands.house.aside(self._gather)
        self._pages.show(desk)

    def _gather(self) -> None:
        """On a thread of its own; the page is only made anew when there is something new."""
        store = self._hands.house.store
        try:
            found = None if store is None else beginnings_of(store)
        except (StoreError, OSError) as error:
            found = None  # one may still drive with a width
            self._hands.tell(self._hands.words("Not done"), self._hands.words.say(str(error)), bad=True)
        try:
            sources = sources_found(self._hands.words, self._hands.house.list_ports)
        finally:
            self._gathering = False
        if (found, sources) != self._shown:
            self._shown = (found, sources)
            self._pages.turn(lambda gui: _Offers(gui, self._hands, found, sources))


class _Offers(Still):
    """The page itself."""

    def __init__(self, gui: viser.GuiApi, hands: Hands, found: Beginnings | None, sources: Mapping[str, str]) -> None:
        self._gui, self._hands, self._words = gui, hands, hands.words
        self._found, self._sources = found, sources
        self._taken: float | None = None
        """How much of a drive that goes on is taken in, 0 to 1; the worker writes it, the redraw shows it."""
        self._said: Shown | None = None
        if found is not None:
            if found.cut_off is not None:
                self._offer_to_go_on(found.cut_off)
            for on_field in found.work:
                self._offer_operations(on_field)
            if not found.work:
                gui.add_html(_steps_html(found, self._words))
        self._offer_to_drive_now()

    # --- going on --------------------------------------------------------------------------------------------------

    def _offer_to_go_on(self, found: Resumable) -> None:
        words = self._words
        self._gui.add_html(heading_html(words("The last drive was cut off")))
        label = words("Go on: {where}", where=cut_off_words(found, words))
        press(self._gui, label, lambda: self._hands.later(partial(self._go_on, found)), "green")
        self._said = Shown(self._gui)
        press(self._gui, words("Leave it as it is"), lambda: self._hands.later(partial(self._leave, found)))

    def _go_on(self, found: Resumable) -> None:
        if not self._hands.wheel.mine():
            return

        def tell(part: float) -> None:
            self._taken = part

        self._hands.house.resume(found, tell)
        self._hands.go(Place.DRIVE)

    def _leave(self, found: Resumable) -> None:
        if not self._hands.wheel.mine():
            return
        finish_recording(found.path)
        self._hands.tell(self._words("The drive is ended; its recording stays."))

    # --- registered operations -------------------------------------------------------------------------------------

    def _offer_operations(self, on_field: OnField) -> None:
        self._gui.add_html(f'<div class="g-sub">{html.escape(on_field.field)}</div>')
        for name in on_field.operations:
            press(
                self._gui, f"▶ {name}", partial(self._hands.later, partial(self._drive, name, on_field.field)), "green"
            )

    def _drive(self, operation: str, field: str) -> None:
        if not self._hands.wheel.mine():
            return
        store = self._hands.house.store
        assert store is not None, "an operation comes from a store"
        self._hands.house.drive(load_job(store, operation, field))
        self._hands.go(Place.DRIVE)

    # --- now -------------------------------------------------------------------------------------------------------

    def _offer_to_drive_now(self) -> None:
        words, found = self._words, self._found
        current = self._hands.house.manager.job.receiver.source
        last = LastTime(source=current) if found is None or not found.last.source else found.last
        self._gui.add_html(f'<div class="g-sub">{html.escape(words("Drive now, without a plan"))}</div>')
        tractors = () if found is None else found.tractors
        implements = () if found is None else found.implements
        registered = () if found is None else found.receivers
        receivers = [(f"receiver {name}", name) for name, _ in registered]
        receivers += [(uri, label) for label, uri in self._sources.items()]
        receivers += [(uri, uri) for uri in dict.fromkeys((last.source, current)) if uri not in dict(receivers)]
        initial = {
            "implement": last.implement if last.implement in implements else "",
            "working_width": last.width,
            "tractor": last.tractor if last.tractor in tractors else "",
            "receiver": _receiver_of(last, registered, receivers),
        }
        self._form = Form(
            self._gui,
            _DriveNow,
            initial,
            words,
            self._hands.house.settings().units,
            options={
                "implement": [("", message("Only a width")), *((one, one) for one in implements)],
                "tractor": [("", message("Any tractor")), *((one, one) for one in tractors)],
                "receiver": receivers,
            },
            touched=self._hands.soon,
        )
        press(self._gui, words("Drive now"), lambda: self._hands.later(self._drive_now), "green")

    def _drive_now(self) -> None:
        wanted = self._form.read()
        if wanted is None or not self._hands.wheel.mine():
            return
        store = self._hands.house.store
        words = self._words
        tractor = Tractor(name=words("Tractor"))
        implement = Implement(name=words("Implement"), working_width=wanted.working_width)
        receiver = Receiver(name=words("Receiver"), source=wanted.receiver)
        if store is not None:
            if wanted.tractor:
                tractor = store.load(Tractor, wanted.tractor).document
            if wanted.implement:
                implement = store.load(Implement, wanted.implement).document
            if wanted.receiver.startswith("receiver "):
                receiver = store.load(Receiver, wanted.receiver.removeprefix("receiver ")).document
        settings = self._hands.house.settings()
        self._hands.house.drive(Job(tractor=tractor, implement=implement, receiver=receiver, settings=settings))
        self._hands.go(Place.DRIVE)

    def show(self, desk: Desk) -> None:
        """Brings the form up to what was touched, and the progress up to now."""
        if self._said is not None and self._taken is not None:
            percent = self._words.number(100 * self._taken)
            self._said.show(notice_html([self._words("Taking the drive again: {percent} %", percent=percent)]))
        self._form.show(desk)


def _receiver_of(last: LastTime, registered: tuple[tuple[str, str], ...], offered: list[tuple[str, str]]) -> str:
    """The receiver of the last time, by its name or its address; before any, a registered or a plugged one."""
    keys = [key for key, _ in offered]
    named = f"receiver {last.receiver}"
    if named in keys:
        return named
    if last != LastTime(source=SIMULATED):
        return last.source
    if registered:
        return f"receiver {registered[0][0]}"
    return next((key for key in keys if key.startswith("serial:")), SIMULATED)


def _steps_html(found: Beginnings, words: Words) -> str:
    """What is still missing for a planned drive, in the order in which it is done."""
    steps = (
        (bool(found.tractors), words("Register a tractor, under Machines")),
        (bool(found.implements), words("Register an implement, under Machines")),
        (bool(found.receivers), words("Register a receiver, under Machines")),
        (found.fields > 0, words("Register a field, under Fields")),
        (bool(found.work), words("Register an operation, under Jobs")),
    )
    lines = "".join(f"<div>{'☑' if done else '☐'} {html.escape(text)}</div>" for done, text in steps)
    said = html.escape(words("To drive by a plan:"))
    return f'<div class="g-said g-steps"><b>{said}</b>{lines}</div>'
