"""The work panel: who says when the implement works, which pass, and where the lines stand."""

from functools import partial
from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Choice, buttons
from guidance_app.model import (
    DropOffset,
    LineHere,
    Nudge,
    OffsetKind,
    ReverseDirection,
    SetWorkMode,
    SkipPass,
    TakePass,
    WorkMode,
)
from guidance_app.view.status import neighbour, nudge_steps, work_view

__all__ = ["Work"]

_MODES = {"Auto": WorkMode.AUTO, "Button": WorkMode.BUTTON, "Speed": WorkMode.SPEED, "Switch": WorkMode.SWITCH}
_WORDS = {mode: words for words, mode in _MODES.items()}


class Work:
    """Posts commands; every row says in its label what is."""

    title: ClassVar[str] = "Work"

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        post = hands.post
        self._pass = buttons(
            gui,
            "No line",
            (("◀ Line", lambda: self._take(-1)), ("Line ▶", lambda: self._take(1)), ("Skip", lambda: post(SkipPass()))),
        )
        steps = nudge_steps(hands.desk().units)
        self._line = buttons(gui, "Line", tuple((words, partial(post, Nudge(metres))) for words, metres in steps))
        here = (("Here", lambda: post(LineHere())), ("As planned", self._drop_offsets))
        self._way = buttons(gui, "Line", (*here, ("Other way", lambda: post(ReverseDirection()))))
        self._mode = Choice(gui, "Works by", tuple(_MODES), lambda words: post(SetWorkMode(_MODES[words])))

    def _take(self, step: int) -> None:
        number = neighbour(self._hands.desk().snapshot, step)
        if number is not None:
            self._hands.post(TakePass(number))

    def _drop_offsets(self) -> None:
        for kind in (OffsetKind.NUDGE, OffsetKind.SHIFT, OffsetKind.LINE_HERE):
            self._hands.post(DropOffset(kind))

    def show(self, desk: Desk) -> None:
        """Brings labels and marks up to what is."""
        view = work_view(desk.snapshot, desk.now, desk.units)
        self._pass.label = view.pass_words
        self._line.label = view.line_words
        self._mode.show(_WORDS[desk.snapshot.work_mode])
