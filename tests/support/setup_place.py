"""A console where things are set up, with one client that presses, types and reads."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import viser

from guidance_app.console.house import House
from guidance_app.console.screen import Screen
from guidance_app.documents import Implement, Operation, Receiver, Tractor
from guidance_app.runtime import SessionManager
from guidance_app.store import Store
from support.viser_client import ViserClient, viser_client

__all__ = ["SetupPlace", "setup_place"]

MOST_REDRAWS = 2000
SOON_S = 0.03


class SetupPlace:
    """One console and one client. Everything waits until it has happened."""

    def __init__(self, house: House, screen: Screen, client: ViserClient) -> None:
        self.house = house
        self.screen = screen
        self.client = client

    @property
    def store(self) -> Store:
        assert self.house.store is not None
        return self.house.store

    def until(self, true: Callable[[], Any]) -> None:
        """Redraws until it is so."""
        for _ in range(MOST_REDRAWS):
            self.screen.tick()
            if self.client.soon(true, SOON_S):
                return
        pytest.fail(f"it did not happen; told: {self.told()}; the panels say: {self.client.words()}")

    def told(self) -> str:
        """Every notification so far."""
        return "\n".join(str(one) for one in self.client.messages if one["type"].startswith("Notification"))

    def press(self, words: str) -> None:
        """Presses the button of these words once it is there."""
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

    def newest(self, label: str) -> dict[str, Any] | None:
        """The control that came last of those with this label, or with this word among its buttons."""
        for control in reversed(list(self.client.controls.values())):
            props = control["props"]
            options = [one.removeprefix("● ") for one in props.get("options", ())]
            buttons = options if control["type"] == "GuiButtonGroupMessage" else []
            if props.get("visible", True) and (props.get("label") == label or label in buttons):
                return control
        return None

    def says(self, pattern: str) -> None:
        """Waits until the panels or a notification say this."""
        self.until(lambda: re.search(pattern, self.client.words()) or re.search(pattern, self.told()))

    def names(self, kind: type[Tractor | Implement | Receiver | Operation]) -> list[str]:
        """The names of what is stored."""
        return [one.document.name for one in self.store.list(kind)]


@contextmanager
def setup_place(server: viser.ViserServer, folder: Path) -> Iterator[SetupPlace]:
    """A console on this data folder that drives nothing."""
    manager = SessionManager()
    manager.start()
    house = House(manager, Store(folder))
    screen = Screen(server, house)
    screen.attach()
    try:
        with viser_client(server) as client:
            yield SetupPlace(house, screen, client)
    finally:
        house.close()
        manager.close()
