"""The views panel: how the driver looks at the field, day or night, and how far ahead the tractor is predicted."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Choice, Followed
from guidance_app.estimation.prediction import LOOK_AHEAD_MAX, LOOK_AHEAD_MIN
from guidance_app.model import SetLookAhead
from guidance_app.view.camera import ViewMode

__all__ = ["Views"]

_NIGHT = {"Day": False, "Night": True}


class Views:
    """Each client chooses its own view; day and night are one for all, like the lamp in the cab."""

    title: ClassVar[str] = "Views"

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        follow = (ViewMode.DRIVER, ViewMode.HEADING_UP, ViewMode.NORTH_UP)
        self._follow = Choice(gui, "View", follow, lambda words: hands.look(ViewMode(words)))
        self._whole = Choice(
            gui,
            "",
            (ViewMode.WHOLE_FIELD,),
            lambda words: hands.look(ViewMode(words)),
            {"Bring back": hands.bring_back},
        )
        self._light = Choice(gui, "Light", tuple(_NIGHT), lambda words: hands.set_night(_NIGHT[words]))
        slider = gui.add_slider(
            "Look ahead",
            LOOK_AHEAD_MIN,
            LOOK_AHEAD_MAX,
            0.1,
            hands.desk().snapshot.look_ahead_s,
            marks=((LOOK_AHEAD_MIN, "0.5 s"), (LOOK_AHEAD_MAX, "3 s")),
        )
        self._ahead = Followed(slider, lambda seconds: hands.post(SetLookAhead(float(seconds))))

    def show(self, desk: Desk) -> None:
        """Brings marks and slider up to what is."""
        self._follow.show(desk.mode)
        self._whole.show(desk.mode)
        self._light.show("Night" if desk.night else "Day")
        self._ahead.show(round(desk.snapshot.look_ahead_s, 1))
