"""Corrections for the receiver: the account at a caster, a try of it, and what comes from it while driving.

The password goes from the page to the data folder and never back: what is kept shows as an empty entry.
"""

import threading
import time
from collections.abc import Mapping
from typing import Any

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.forms import Form
from guidance_app.console.pages import press
from guidance_app.console.widgets import Shown, words_html
from guidance_app.documents.caster import CasterAccount
from guidance_app.language import sentence
from guidance_app.model import CORRECTIONS
from guidance_app.runtime import caster_of
from guidance_app.sources import takes_corrections
from guidance_app.sources.kept import LinkError
from guidance_app.sources.ntrip import first_corrections, mount_points
from guidance_app.store import StoreError
from guidance_app.store.caster import caster_account, forget_caster_account, keep_caster_account
from guidance_app.view.receiver import caster_words
from guidance_app.view.status import Level

__all__ = ["CorrectionsForm"]

NOBODY = CasterAccount.model_construct()
"""What a form begins with."""
ANY = "-"
"""Stands for a mount point that is not chosen yet."""


class CorrectionsForm:
    """A folded part of the receiver's panel; without a data folder there is nothing to keep, and it is not there."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands, self._words = hands, hands.words
        self._root = None if hands.house.store is None else hands.house.store.root
        self._kept: CasterAccount | None = None
        self._answer: tuple[str, Level] | None = None
        """Of the last press; until the next one it stands below the buttons."""
        self._found: tuple[str, ...] = ()
        self._chosen: str | None = None
        self._changing = threading.Lock()
        self._to_empty = False
        """Whether the password that was typed is kept now, and leaves the page."""
        if self._root is None:
            return
        try:
            self._kept = caster_account(self._root)
        except StoreError as error:
            self._answer = str(error), "bad"
        words = self._words
        with gui.add_folder(words("Corrections (NTRIP)"), expand_by_default=False):
            self._state = Shown(gui)
            initial = {**(self._kept or NOBODY).model_dump(), "password": ""}
            self._form = Form(gui, CasterAccount, initial, words, hands.house.settings().units, touched=hands.soon)
            self._streams: Any = gui.add_dropdown(words("Mount points there"), ("",), visible=False)
            press(gui, words("List its mount points"), lambda: hands.later(self._list))
            press(gui, words("Save the caster"), lambda: hands.later(self._save), "green")
            press(gui, words("Try it"), lambda: hands.later(self._try))
            self._forget_button = press(gui, words("Forget the caster"), lambda: hands.later(self._forget))
            self._said = Shown(gui)

        @self._streams.on_update
        async def _(event: viser.GuiEvent[viser.GuiDropdownHandle[str]]) -> None:
            if event.client_id is not None and self._streams.value in self._found:
                self._chosen = self._streams.value
                hands.soon()

    def show(self, desk: Desk) -> None:
        """What comes from the caster, and what the last press has led to."""
        if self._root is None:
            return
        if self._to_empty:
            self._to_empty = False
            self._form.set("password", "")
        chosen, self._chosen = self._chosen, None
        if chosen is not None:
            self._form.set("mount", chosen)
        self._offer()
        self._form.show(desk)
        self._state.show(_long_html(*self._state_words(desk)))
        self._forget_button.visible = self._kept is not None
        answer = self._answer
        self._said.show("" if answer is None else _long_html(self._words.say(answer[0]), answer[1]))

    def _offer(self) -> None:
        """The mount points that were found; a choice among the same ones stays."""
        found = self._found
        options = (self._words("choose one of {n}", n=len(found)), *found)
        if found and tuple(self._streams.options) != options:
            self._streams.options = options
            self._streams.value = options[0]
        self._streams.visible = bool(found)

    def _state_words(self, desk: Desk) -> tuple[str, Level]:
        words, kept, house = self._words, self._kept, self._hands.house
        link = desk.snapshot.links_beside.get(CORRECTIONS)
        if link is not None:
            newest = house.corrections.newest
            age = None if newest is None else time.monotonic() - newest
            return caster_words(link, house.corrections.received, age, words)
        if kept is None:
            return words("No caster is entered."), "off"
        if not kept.on:
            return words("Corrections are switched off."), "off"
        if not house.driving:
            return words("{mount} of {host} is asked when a drive begins.", mount=kept.mount, host=kept.host), "off"
        if not takes_corrections(house.manager.job.receiver.source):
            return words("This receiver takes no corrections: one at a serial:// or tcp:// address does."), "fair"
        return words("This drive goes without: the next one takes the corrections."), "fair"

    # --- pressed: on a worker ----------------------------------------------------------------------------------------

    def _read(self, instead: Mapping[str, str] | None = None) -> CasterAccount | None:
        """What is typed; the kept password goes to nobody but the caster and user that it was kept for."""
        typed = self._form.read(instead)
        kept = self._kept
        if typed is None or typed.password or kept is None or (typed.host, typed.user) != (kept.host, kept.user):
            return typed
        return typed.model_copy(update={"password": kept.password})

    def _save(self) -> None:
        with self._changing:
            account = self._read()
            if account is None or self._root is None:
                return
            keep_caster_account(self._root, account)
            self._kept = account
            self._to_empty = True
            later = self._hands.house.driving
            self._say(sentence("Kept. The next drive takes it.") if later else sentence("Kept."), "good")

    def _try(self) -> None:
        account = self._read()
        if account is None:
            return
        self._say(sentence("Asking {host} …", host=account.host), "fair")
        try:
            received = first_corrections(caster_of(account))
        except LinkError as error:
            self._say(error.args[0], "bad")
            return
        if received:
            self._say(sentence("{mount} gives corrections.", mount=account.mount), "good")
        else:
            self._say(
                sentence(
                    "{host} accepts user and password and has sent nothing yet: it may wait for a position.",
                    host=account.host,
                ),
                "good",
            )

    def _list(self) -> None:
        account = self._read({"mount": ANY})
        if account is None:
            return
        self._say(sentence("Asking {host} …", host=account.host), "fair")
        try:
            self._found = mount_points(caster_of(account))
        except LinkError as error:
            self._say(error.args[0], "bad")
            return
        self._say(sentence("Choose the mount point above."), "good")

    def _forget(self) -> None:
        if self._root is None:
            return
        with self._changing:
            forget_caster_account(self._root)
            self._kept = None
            self._say(sentence("The caster and its password are forgotten."), "good")

    def _say(self, said: str, level: Level) -> None:
        self._answer = said, level
        self._hands.soon()


def _long_html(said: str, level: Level) -> str:
    """Words that may need more than a line."""
    return f'<div class="g-long">{words_html(said, level)}</div>'
