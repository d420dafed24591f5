"""The panels of the console, one a file. The tables say which are shown where; a panel in none is not shown."""

from guidance_app.console.desk import Panel, Place
from guidance_app.console.panels.fields import Fields
from guidance_app.console.panels.info import Info
from guidance_app.console.panels.line import Line
from guidance_app.console.panels.machines import Machines
from guidance_app.console.panels.menu import Menu
from guidance_app.console.panels.operations import Operations
from guidance_app.console.panels.plan import Plan
from guidance_app.console.panels.position import Position
from guidance_app.console.panels.receiver import Receiver
from guidance_app.console.panels.recordings import Recordings
from guidance_app.console.panels.replay import Replay
from guidance_app.console.panels.rest import Rest
from guidance_app.console.panels.settings import Settings
from guidance_app.console.panels.start import Start
from guidance_app.console.panels.summary import Summary
from guidance_app.console.panels.views import Views
from guidance_app.console.panels.work import Work
from guidance_app.console.panels.yard import Yard

__all__ = ["HEAD", "PANELS", "SETUP_PANELS"]

HEAD: dict[Place, type[Panel]] = {Place.DRIVE: Summary, Place.SETUP: Yard}
"""What is always in sight, above the tabs."""

PANELS: dict[str, type[Panel]] = {
    "work": Work,
    "rest": Rest,
    "line": Line,
    "position": Position,
    "views": Views,
    "replay": Replay,
    "info": Info,
    "receiver": Receiver,
    "menu": Menu,
}
"""While driving: by the name of their file, in the order of the tabs."""

SETUP_PANELS: dict[str, type[Panel]] = {
    "start": Start,
    "fields": Fields,
    "machines": Machines,
    "operations": Operations,
    "plan": Plan,
    "receiver": Receiver,
    "recordings": Recordings,
    "settings": Settings,
}
"""While setting up, in the order of the tabs."""
