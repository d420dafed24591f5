"""The work panel: who says when the implement works, which pass, and where the lines stand."""

from functools import partial
from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.widgets import Choice, Shown, buttons, note_html
from guidance_app.language import Words, message
from guidance_app.model import (
    DropOffset,
    LineHere,
    Nudge,
    OffsetKind,
    ReverseDirection,
    SessionState,
    SetSection,
    SetWorkMode,
    SkipPass,
    TakePass,
    WorkMode,
)
from guidance_app.view.drive import pass_work_words, pause_press, state_words
from guidance_app.view.status import neighbour, nudge_steps, work_view

__all__ = ["Work"]

STANDING = frozenset({SessionState.INITIALISING, SessionState.PAUSED, SessionState.ENDED})
PAUSABLE = frozenset({SessionState.DRIVING, SessionState.PAUSED})
IN_A_ROW = 8
OFF_MARK = "✕ "


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
        self._turns = {
            words("◀ Line"): lambda: self._take(-1),
            words("Line ▶"): lambda: self._take(1),
            words("Skip"): lambda: post(SkipPass()),
        }
        self._pass = gui.add_button_group(words("No line"), tuple(self._turns))
        self._pass.on_click(self._pressed)
        steps = nudge_steps(hands.desk().units)
        self._line = buttons(gui, words("Line"), tuple((name, partial(post, Nudge(metres))) for name, metres in steps))
        here = ((words("Here"), lambda: post(LineHere())), (words("As planned"), self._drop_offsets))
        self._way = buttons(gui, words("Line"), (*here, (words("Other way"), lambda: post(ReverseDirection()))))
        self._names = _modes(words)
        modes = {name: mode for mode, name in self._names.items()}
        self._mode = Choice(gui, words("Works by"), tuple(modes), lambda name: post(SetWorkMode(modes[name])))
        self._pass_work = Shown(gui)
        self._sections = _Sections(gui, hands)

    async def _pressed(self, event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        """A step to another line, or the pause, which stands in the same row."""
        turn = self._turns.get(event.target.value)
        if turn is not None:
            turn()
        else:
            command = pause_press(self._hands.desk().snapshot, self._words).command
            if command is not None:
                self._hands.post(command)

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
        state = desk.snapshot.state
        self._pass.label = state_words(state, self._words) if state in STANDING else view.pass_words
        pause = (pause_press(desk.snapshot, self._words).words,) if state in PAUSABLE else ()
        options = (*self._turns, *pause)
        if self._pass.options != options:
            self._pass.options = options
        self._line.label = view.line_words
        self._mode.show(self._names[desk.snapshot.work_mode])
        said = pass_work_words(desk.snapshot, desk.units, self._words)
        self._pass_work.show(note_html(said) if said else "")
        self._sections.show(desk)


class _Sections:
    """The sections of an implement that has more than one, eight in a row, from left to right."""

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._words = words = hands.words
        self._hands = hands
        self._rows: list[viser.GuiButtonGroupHandle] = []
        count = hands.house.manager.job.implement.sections
        for first in range(1, count + 1 if count > 1 else 1, IN_A_ROW):
            last = min(first + IN_A_ROW - 1, count)
            row = gui.add_button_group(
                words("Sections {first} to {last}", first=first, last=last),
                tuple(str(number) for number in range(first, last + 1)),
            )
            row.on_click(self._pressed)
            self._rows.append(row)

    async def _pressed(self, event: viser.GuiEvent[viser.GuiButtonGroupHandle]) -> None:
        number = int(event.target.value.removeprefix(OFF_MARK))
        on = self._hands.desk().snapshot.sections
        if number <= len(on):
            self._hands.post(SetSection(number, on=not on[number - 1]))

    def show(self, desk: Desk) -> None:
        """Marks the sections that are switched off."""
        on = desk.snapshot.sections
        for place, row in enumerate(self._rows):
            first = place * IN_A_ROW
            marked = enumerate(on[first : first + IN_A_ROW], start=first + 1)
            options = tuple(str(number) if one else f"{OFF_MARK}{number}" for number, one in marked)
            if options and row.options != options:
                row.options = options
