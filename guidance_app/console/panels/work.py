"""The work panel: who says when the implement works, which pass, and where the lines stand."""

from functools import partial
from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Choice, buttons
from guidance_app.language import Words, message
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


def _modes(words: Words) -> dict[WorkMode, str]:
    return {
        WorkMode.AUTO: words("Auto"),
        WorkMode.BUTTON: words("Button"),
        WorkMode.SPEED: words("Speed"),
        WorkMode.SWITCH: words("Switch"),
    }


class Work:
    """Posts commands; every row says in its label what is."""

    title: ClassVar[str] = message("Work")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        self._words = words = hands.words
        post = hands.post
        self._pass = buttons(
            gui,
            words("No line"),
            (
                (words("◀ Line"), lambda: self._take(-1)),
                (words("Line ▶"), lambda: self._take(1)),
                (words("Skip"), lambda: post(SkipPass())),
            ),
        )
        steps = nudge_steps(hands.desk().units)
        self._line = buttons(gui, words("Line"), tuple((name, partial(post, Nudge(metres))) for name, metres in steps))
        here = ((words("Here"), lambda: post(LineHere())), (words("As planned"), self._drop_offsets))
        self._way = buttons(gui, words("Line"), (*here, (words("Other way"), lambda: post(ReverseDirection()))))
        self._names = _modes(words)
        modes = {name: mode for mode, name in self._names.items()}
        self._mode = Choice(gui, words("Works by"), tuple(modes), lambda name: post(SetWorkMode(modes[name])))

    def _take(self, step: int) -> None:
        number = neighbour(self._hands.desk().snapshot, step)
        if number is not None:
            self._hands.post(TakePass(number))

    def _drop_offsets(self) -> None:
        for kind in (OffsetKind.NUDGE, OffsetKind.SHIFT, OffsetKind.LINE_HERE):
            self._hands.post(DropOffset(kind))

    def show(self, desk: Desk) -> None:
        """Brings labels and marks up to what is."""
        view = work_view(desk.snapshot, desk.now, desk.units, self._words)
        self._pass.label = view.pass_words
        self._line.label = view.line_words
        self._mode.show(self._names[desk.snapshot.work_mode])
