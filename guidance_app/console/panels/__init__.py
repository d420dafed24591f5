"""The panels of the console, one a file. ``PANELS`` is their table; a panel that is missing here is not shown."""

from guidance_app.console.desk import Panel
from guidance_app.console.panels.info import Info
from guidance_app.console.panels.replay import Replay
from guidance_app.console.panels.summary import Summary
from guidance_app.console.panels.views import Views
from guidance_app.console.panels.work import Work

__all__ = ["PANELS"]

PANELS: dict[str, type[Panel]] = {
    "summary": Summary,
    "work": Work,
    "views": Views,
    "replay": Replay,
    "info": Info,
}
"""By the name of their file, in the order of the tabs; the summary is the head above them."""
