"""The replay panel: play, pause, how fast, and to any second of the recording."""

from collections.abc import Callable
from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.reviewing.comparing import Comparing
from guidance_app.console.widgets import Choice, Followed, Shown, buttons, notice_html, rows_html
from guidance_app.language import message
from guidance_app.runtime import ReplaySession
from guidance_app.view.status import clock, replay_rows

__all__ = ["Replay"]

_SPEEDS = {"½": 0.5, "1": 1.0, "2": 2.0, "5": 5.0, "10": 10.0, "50": 50.0}
_NAMES = {speed: name for name, speed in _SPEEDS.items()}


class Replay:
    """Steers the recording for all who look at it, so it asks for the wheel; there only when one is played."""

    title: ClassVar[str] = message("Replay")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        control = hands.replay
        if control is None:
            msg = "the replay panel needs a session that plays a recording"
            raise ValueError(msg)
        self._words = words = hands.words
        self._control = control

        def steer(action: Callable[[], object]) -> None:
            if hands.wheel.mine():
                action()

        state = control.state
        self._play = gui.add_button(words("Pause"), color="green")

        @self._play.on_click
        async def _(_: object) -> None:
            steer(control.pause if control.state.playing else control.play)

        end = max(round(state.duration), 1)
        slider = gui.add_slider("00:00", 0, end, 1, 0, marks=((0, words("start")), (end, clock(state.duration))))
        self._slider = slider
        self._position = Followed(slider, lambda second: steer(lambda: control.seek(float(second))))
        steps = (
            (words("Before"), lambda: steer(lambda: control.step_pass(-1))),
            (words("Next"), lambda: steer(lambda: control.step_pass(1))),
        )
        self._passes = buttons(gui, words("Pass"), steps)

        def run_at(name: str) -> None:
            steer(lambda: control.set_speed(_SPEEDS[name]))

        self._speed = Choice(gui, words("Speed ×"), tuple(_SPEEDS), run_at)
        self._rows = Shown(gui)
        self._notices = Shown(gui)
        session = hands.house.manager.session
        self._comparing = Comparing(gui, hands, session) if isinstance(session, ReplaySession) else None

    def show(self, desk: Desk) -> None:
        """Brings button, slider and words up to where the recording is."""
        state = desk.replay
        if state is None:
            return
        self._play.label = self._words("Pause" if state.playing else ("Play again" if state.ended else "Play"))
        self._slider.label = clock(state.position)
        self._position.show(int(state.position))
        self._speed.show(_NAMES.get(state.speed, ""))
        self._passes.visible = bool(self._control.passes)
        rows = replay_rows(state.position, state.duration, state.speed, state.catching_up, self._words)
        self._rows.show(rows_html(rows))
        notices = [self._words.say(one) for one in desk.snapshot.notices]
        if state.indexed is not None and state.indexed < 1.0:
            part = int(100 * state.indexed)
            notices.append(self._words("Getting ready for jumps to any second: {part} %", part=part))
        self._notices.show(notice_html(notices))
        if self._comparing is not None:
            self._comparing.show(desk)
