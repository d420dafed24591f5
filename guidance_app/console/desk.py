"""What a panel is given: what it may say, and what it may do. A panel knows neither session nor scene."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import viser

from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.model import Command, Snapshot
from guidance_app.runtime import ReplayControl, ReplayState
from guidance_app.view.camera import ViewMode

__all__ = ["Desk", "Hands", "Panel"]


@dataclass(frozen=True, slots=True)
class Desk:
    """All that panels may show, at one instant, for one client."""

    snapshot: Snapshot
    now: float
    units: Units
    mode: ViewMode
    night: bool
    replay: ReplayState | None


@dataclass(frozen=True, slots=True)
class Hands:
    """What panels may do. Each returns at once and may be called from any thread."""

    post: Callable[[Command], None]
    look: Callable[[ViewMode], None]
    bring_back: Callable[[], None]
    set_night: Callable[[bool], None]
    desk: Callable[[], Desk]
    replay: ReplayControl | None
    words: Words
    """In the driver's language; when it changes, the panels are made anew."""


class Panel(Protocol):
    """One panel of one client. It is made inside its tab, then told what is."""

    title: ClassVar[str]

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None: ...

    def show(self, desk: Desk) -> None:
        """Brings its words and widgets up to what is; never the other way round."""
        ...
