"""A console with one client that presses, types, taps, sends files and reads; driving nothing unless asked."""

import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import viser

from guidance_app.console.files import Download
from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.documents import FieldDocument, Implement, Operation, Receiver, Tractor
from guidance_app.language import words_for
from guidance_app.runtime import SessionManager
from guidance_app.sources.ports import ListPorts, found_ports
from guidance_app.store import Store
from support.viser_client import Redraws, ViserClient, viser_client

__all__ = ["SetupPlace", "setup_place"]

MOST_REDRAWS = 2000
SOON_S = 0.03


class SetupPlace:
    """One console and one client. Everything waits until it has happened; ``each_redraw`` is called before each.

    What the client knows is always a whole redraw, so a form that is seen has all its buttons.
    """

    def __init__(self, server: viser.ViserServer, house: House, screen: Screen, client: ViserClient) -> None:
        self.house = house
        self._redraws = Redraws(server, screen.tick)
        self.screen = screen
        self.client = client
        self.each_redraw: Callable[[], None] = lambda: None

    @property
    def store(self) -> Store:
        assert self.house.store is not None
        return self.house.store

    # --- what is seen ----------------------------------------------------------------------------------------------

    def until(self, true: Callable[[], Any]) -> None:
        """Redraws until it is so."""
        for _ in range(MOST_REDRAWS):
            self.each_redraw()
            self._redraws.next(self.client)
            if self.client.soon(true, SOON_S):
                return
        pytest.fail(f"it did not happen; told: {self.told()}; the panels say: {self.client.words()}")

    def is_open(self) -> bool:
        """Whether the first page of each tab has come: what comes later belongs to a later page."""
        words = words_for(self.house.settings().language)
        no_field = words("No field is registered yet. Tap its corners, drive around it, type it, or take a file.")
        fields = self.newest(words("Rename")) or no_field in self.client.words()
        return bool(fields and self.newest(words("New operation")) and self.newest(words("Drive now")))

    def told(self) -> str:
        """Every notification so far."""
        return "\n".join(str(one) for one in self.client.messages if one["type"].startswith("Notification"))

    def says(self, pattern: str) -> None:
        """Waits until the panels or a notification say this."""
        self.until(lambda: re.search(pattern, self.client.words()) or re.search(pattern, self.told()))

    def sees(self, *nodes: str) -> None:
        """Waits until these are in the scene."""
        self.until(lambda: all(one in self.client.nodes for one in nodes))

    def sees_no(self, *nodes: str) -> None:
        """Waits until none of these is in the scene."""
        self.until(lambda: not any(one in self.client.nodes for one in nodes))

    def newest(self, label: str) -> dict[str, Any] | None:
        """The control that came last of those with this label, or with this word among its buttons.

        While a form is open its own goes before those of other tabs, which may be made anew at any time.
        """
        controls = list(reversed(list(self.client.controls.values())))
        form = next((one["container_uuid"] for one in controls if "g-title" in _content(one)), None)
        found = [one for one in controls if _is_called(one, label)]
        return next((one for one in found if self._is_within(one, form)), found[0] if found else None)

    def _is_within(self, control: dict[str, Any], container: str | None) -> bool:
        while control["container_uuid"] != container:
            outer = self.client.controls.get(control["container_uuid"])
            if outer is None:
                return False
            control = outer
        return True

    def label(self, beginning: str) -> str:
        """The first label that begins so, once there is one."""

        def found() -> list[str]:
            labels = [str(one["props"].get("label")) for one in self.client.controls.values()]
            return [one for one in labels if one.startswith(beginning)]

        self.until(found)
        return found()[0]

    def names(self, kind: type[Tractor | Implement | Receiver | FieldDocument | Operation]) -> list[str]:
        """The names of what is stored."""
        return [one.document.name for one in self.store.list(kind)]

    # --- what is done ----------------------------------------------------------------------------------------------

    def press(self, words: str) -> None:
        """Presses the button of these words once it is in sight."""
        self.until(lambda: self.newest(words))
        control = self.newest(words)
        assert control is not None
        value = next((one for one in control["props"].get("options", ()) if one.removeprefix("● ") == words), True)
        self._send(control, value)

    def fill(self, label: str, value: Any) -> None:
        """Types into, chooses from, or switches the input of this label."""
        self.until(lambda: self.newest(label))
        control = self.newest(label)
        assert control is not None
        control["value"] = value  # a browser shows it at once
        self._send(control, value)

    def open_form(self, button: str) -> None:
        """Presses the button that opens an empty form of the same title, and waits for its last button."""
        self.press(button)
        self.until(lambda: self._form_is_whole(button))

    def _form_is_whole(self, title: str) -> bool:
        begun = False
        for control in list(self.client.controls.values()):
            props = control["props"]
            begun = begun or f'"g-title">{title}<' in str(props.get("content"))
            if begun and props.get("label") == "Save":
                return True
        return False

    def _send(self, control: dict[str, Any], value: Any) -> None:
        self.client._say(type="GuiUpdateMessage", uuid=control["uuid"], updates={"value": value})

    # --- files -----------------------------------------------------------------------------------------------------

    def token(self, after: str) -> str:
        """Under which a file is awaited by the newest button behind these words."""
        pattern = rf'{after}.*?data-upload="([^"]+)"'
        self.until(lambda: re.search(pattern, self.client.words(), re.DOTALL))
        return str(re.findall(pattern, self.client.words(), re.DOTALL)[-1])

    def send(self, after: str, name: str, content: bytes) -> None:
        """What the front does with a file that was chosen there, on a thread of its own."""
        take = self.house.files.taker(self.token(after))
        assert take is not None
        sending = threading.Thread(target=take, args=(name, content), name="front")
        sending.start()
        sending.join()

    def made(self, label: str) -> Download:
        """What the front sends for the newest link of this label."""
        pattern = rf'/download/([\w.-]+)"[^>]*>{re.escape(label)}<'
        self.until(lambda: re.search(pattern, self.client.words()))
        make = self.house.files.maker(re.findall(pattern, self.client.words())[-1])
        assert make is not None
        made = make()
        assert made is not None
        return made


def _content(control: dict[str, Any]) -> str:
    return str(control["props"].get("content"))


def _is_called(control: dict[str, Any], label: str) -> bool:
    props = control["props"]
    options = [one.removeprefix("● ") for one in props.get("options", ())]
    buttons = options if control["type"] == "GuiButtonGroupMessage" else []
    return bool(props.get("visible", True)) and (props.get("label") == label or label in buttons)


@contextmanager
def setup_place(
    server: viser.ViserServer,
    folder: Path | None,
    session: Any = None,
    *,
    list_ports: ListPorts = found_ports,
) -> Iterator[SetupPlace]:
    """A console on this data folder, None for none, that drives nothing unless a session is given."""
    manager = SessionManager(session)
    if session is None:
        manager.start()
    house = House(manager, None if folder is None else Store(folder), list_ports)
    screen = Screen(server, house)
    screen.attach()
    try:
        with viser_client(server) as client:
            place = SetupPlace(server, house, screen, client)
            if session is None and folder is not None:
                place.until(place.is_open)
            yield place
    finally:
        house.close()
        manager.close()
