"""The views panel: how the driver looks at the field, day or night, and how far ahead the tractor is predicted."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Choice, Followed
from guidance_app.estimation.prediction import LOOK_AHEAD_MAX, LOOK_AHEAD_MIN
from guidance_app.language import Words, message
from guidance_app.model import SetLookAhead
from guidance_app.view.camera import ViewMode

__all__ = ["Views"]


def _names(words: Words) -> dict[ViewMode, str]:
    return {
        ViewMode.DRIVER: words.within("view", "Driver"),
        ViewMode.HEADING_UP: words("Heading up"),
        ViewMode.NORTH_UP: words("North up"),
        ViewMode.WHOLE_FIELD: words("Whole field"),
    }


class Views:
    """Each client chooses its own view; day and night are one for all, like the lamp in the cab."""

    title: ClassVar[str] = message("Views")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        words = hands.words
        self._names = names = _names(words)
        modes = {name: mode for mode, name in names.items()}
        follow = (names[ViewMode.DRIVER], names[ViewMode.HEADING_UP], names[ViewMode.NORTH_UP])
        self._follow = Choice(gui, words("View"), follow, lambda name: hands.look(modes[name]))
        self._whole = Choice(
            gui,
            "",
            (names[ViewMode.WHOLE_FIELD],),
            lambda name: hands.look(modes[name]),
            {words("Bring back"): hands.bring_back},
        )
        self._lights = {False: words("Day"), True: words("Night")}
        lights = tuple(self._lights.values())
        self._light = Choice(gui, words("Light"), lights, lambda name: hands.set_night(name == self._lights[True]))
        slider = gui.add_slider(
            words("Look ahead"),
            LOOK_AHEAD_MIN,
            LOOK_AHEAD_MAX,
            0.1,
            hands.desk().snapshot.look_ahead_s,
            marks=tuple((end, words("{seconds:g} s", seconds=end)) for end in (LOOK_AHEAD_MIN, LOOK_AHEAD_MAX)),
        )
        self._ahead = Followed(slider, lambda seconds: hands.post(SetLookAhead(float(seconds))))

    def show(self, desk: Desk) -> None:
        """Brings marks and slider up to what is."""
        self._follow.show(self._names[desk.mode])
        self._whole.show(self._names[desk.mode])
        self._light.show(self._lights[desk.night])
        self._ahead.show(round(desk.snapshot.look_ahead_s, 1))
