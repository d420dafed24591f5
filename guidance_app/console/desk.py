"""What a panel is given: what it may say, and what it may do. A panel knows neither session nor scene."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import ClassVar, Protocol

import viser

from guidance_app.console.house import House
from guidance_app.console.sketch import Sketch
from guidance_app.console.wheel import WheelView
from guidance_app.documents import Units
from guidance_app.language import Words
from guidance_app.model import Command, Snapshot
from guidance_app.runtime import ReplayControl, ReplayState
from guidance_app.view.camera import ViewMode

__all__ = ["Desk", "Hands", "Panel", "Place", "WheelHands"]


class Place(StrEnum):
    """Where one client is: at the wheel with the driving panels, or in the yard where things are set up."""

    DRIVE = "drive"
    SETUP = "setup"


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
class WheelHands:
    """The wheel as one browser has it. ``mine`` says whether it may operate now, and tells the person if not."""

    view: Callable[[], WheelView]
    mine: Callable[[], bool]
    ask: Callable[[], None]
    give: Callable[[], None]
    keep: Callable[[], None]


@dataclass(frozen=True, slots=True)
class Hands:
    """What panels may do. Each returns at once and may be called from any thread.

    ``later`` does long work on another thread; what it raises with a sentence is shown to this client. ``tell`` shows
    words for a few seconds, ``bad`` ones until they are closed. ``go`` changes between driving and setting up;
    ``renew`` makes the panels of all clients anew (another language, other units). ``soon`` shows this client's panels
    at the next redraw instead of within a quarter of a second. The redraw calls what ``at_leaving`` is given once,
    when these panels are left for others or their browser has gone.
    """

    post: Callable[[Command], None]
    look: Callable[[ViewMode], None]
    bring_back: Callable[[], None]
    set_night: Callable[[bool], None]
    desk: Callable[[], Desk]
    replay: ReplayControl | None
    words: Words
    """In the driver's language; when it changes, the panels are made anew."""
    house: House
    sketch: Sketch
    later: Callable[[Callable[[], None]], None]
    tell: Callable[..., None]
    go: Callable[[Place], None]
    renew: Callable[[], None]
    soon: Callable[[], None]
    at_leaving: Callable[[Callable[[], None]], None]
    wheel: WheelHands
    """``post`` of a browser without the wheel does nothing and says so; what begins or ends a drive asks ``mine``."""


class Panel(Protocol):
    """One panel of one client. It is made inside its tab, then told what is."""

    title: ClassVar[str]

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None: ...

    def show(self, desk: Desk) -> None:
        """Brings its words and widgets up to what is; never the other way round."""
        ...
