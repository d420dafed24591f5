"""The operation's form: field, machines, how the passes lie, and the method with a picture of its order.

Members that a method does not use are hidden and keep their value. The plan itself is only shown on demand: it is made
by the planner, from the documents, as a drive would make it.
"""

import html
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import viser
from pydantic import Field

from guidance_app.console.desk import Desk, Hands
from guidance_app.console.forms import Form
from guidance_app.console.on_field import Asked, OnField
from guidance_app.console.pages import press
from guidance_app.console.plan_strokes import draw_plan
from guidance_app.console.widgets import Shown, notice_html, rows_html
from guidance_app.documents import (
    Direction,
    FieldDocument,
    Implement,
    Job,
    Method,
    Operation,
    Receiver,
    Tractor,
    choice,
    quantity,
)
from guidance_app.guidance.pattern import OperationMethod, PatternOptions
from guidance_app.guidance.patterns import METHODS
from guidance_app.guidance.request import PlanError
from guidance_app.language import message
from guidance_app.model import Plan
from guidance_app.store import Store
from guidance_app.view.camera import ViewMode
from guidance_app.view.drawing_orders import line_picture, method_picture
from guidance_app.view.plan_words import plan_cost_rows

__all__ = ["Gathered", "OperationForm", "gathered_from"]

WITH_PASSES = [Method.ROUND_TRIP, Method.TRANSFER, Method.INTERMEDIATE_DIVISION]
PLANNED = [*WITH_PASSES, Method.SURROUNDING]
STRAIGHT = ("ab", "a-plus")
"""Types of guidance lines along which a plan's passes can lie."""
MEMBERS = (
    "name",
    "field",
    "tractor",
    "implement",
    "receiver",
    "method",
    "direction",
    "direction_deg",
    "guidance_line",
    "last_pass",
    "headland",
    "laps",
    "turning_space",
    "laps_first",
    "laps_clockwise",
    "start_corner",
    "end_at_entrance",
    "reverse_allowed",
    "product",
    "driver",
)


class _Entries(Operation):
    """An operation as it is asked for: what a method does not use is not asked."""

    direction: Direction = choice(
        "Direction of the passes",
        Direction.LONGEST_EDGE,
        {
            Direction.LONGEST_EDGE: message("Longest edge"),
            Direction.BEST: message("Best found"),
            Direction.TYPED: message("Typed"),
            Direction.LINE: message("Guidance line"),
            Direction.EDGE: message("Tapped edge"),
        },
        when=("method", WITH_PASSES),
    )
    headland: Literal["needed", "laps", "space"] = choice(
        "Headland",
        "needed",
        {"needed": message("As a turn needs"), "laps": message("Laps"), "space": message("Depth")},
        when=("method", WITH_PASSES),
    )
    laps: int | None = Field(None, title="Headland laps", ge=0, le=20, json_schema_extra={"when": ["headland", "laps"]})
    turning_space: float | None = quantity("Turning space", "m", 0, 200, None, step=0.5, when=("headland", "space"))
    laps_first: bool = Field(
        default=False,
        title="Drive the headland first",
        json_schema_extra={"when": ["method", [str(one) for one in WITH_PASSES]]},
    )
    start_corner: Literal["nearest", "first-left", "first-right", "last-left", "last-right"] = choice(
        "Start corner",
        "nearest",
        {
            "nearest": message("Nearest"),
            "first-left": message("First, left"),
            "first-right": message("First, right"),
            "last-left": message("Last, left"),
            "last-right": message("Last, right"),
        },
        help="Of the first or the last pass, seen along the passes",
        when=("method", WITH_PASSES),
    )
    reverse_allowed: bool = Field(
        default=True,
        title="The tractor may back up in a turn",
        json_schema_extra={"when": ["method", [str(one) for one in PLANNED]]},
    )


@dataclass(frozen=True, slots=True)
class Gathered:
    """The names of what an operation can be made of."""

    fields: tuple[str, ...]
    tractors: tuple[str, ...]
    implements: tuple[str, ...]
    receivers: tuple[str, ...]
    lines: tuple[str, ...]
    """Guidance lines that a plan can follow, of all fields."""
    documents: Mapping[str, FieldDocument]
    """The fields by their names."""


def gathered_from(store: Store) -> Gathered:
    """Reads the names."""
    fields = [one.document for one in store.list(FieldDocument)]
    lines = dict.fromkeys(line.name for field in fields for line in field.lines if line.type in STRAIGHT)
    return Gathered(
        tuple(one.name for one in fields),
        tuple(one.document.name for one in store.list(Tractor)),
        tuple(one.document.name for one in store.list(Implement)),
        tuple(one.document.name for one in store.list(Receiver)),
        tuple(lines),
        {one.name: one for one in fields},
    )


class OperationForm:
    """The form, the method's own options, and the plan on demand."""

    def __init__(
        self,
        hands: Hands,
        gui: viser.GuiApi,
        initial: Mapping[str, Any],
        touched: Callable[[], None],
        gathered: Gathered,
    ) -> None:
        self._gui, self._hands, self._touched = gui, hands, touched
        self._words, self._units = hands.words, hands.house.settings().units
        self._begun_options = dict(initial.get("options", {}))
        self._method: Method | None = None
        self._options: Form[PatternOptions] | None = None
        self._shown_job: Job | None = None
        self._said = ""
        self._drawn_plan: tuple[Plan, int] | None = None
        self._drawn: tuple[Method, dict[str, Any] | None] | None = None
        self._on_field = OnField(hands, gui, initial, gathered.documents, touched)
        names = {
            "field": [(one, one) for one in gathered.fields],
            "tractor": [(one, one) for one in gathered.tractors],
            "implement": [(one, one) for one in gathered.implements],
            "guidance_line": [("", message("The field's first line")), *((one, one) for one in gathered.lines)],
            "receiver": [*((one, one) for one in gathered.receivers), ("", message("Simulated receiver"))],
        }
        self._form = Form(
            gui,
            _Entries,
            _with_headland(initial),
            hands.words,
            self._units,
            options=names,
            members=MEMBERS,
            after={
                "method": self._make_method,
                "guidance_line": self._on_field.make_edge,
                "end_at_entrance": self._on_field.make_exclusions,
            },
            cards=("method",),
            touched=touched,
        )
        self._preview = press(gui, self._words("Show the plan on the map"), lambda: hands.later(self._show_plan))
        self._plan = Shown(gui)
        self.show()

    # --- the method ------------------------------------------------------------------------------------------------

    def _make_method(self) -> None:
        self._cards = Shown(self._gui)
        self._about = Shown(self._gui)
        self._holder = self._gui.add_folder(None)
        self._inner: viser.GuiFolderHandle | None = None

    def _open_options(self, method: Method) -> None:
        """The options of a method newly chosen, as they were stored or by default."""
        self._method = method
        if self._inner is not None:
            self._inner.remove()
        with self._holder:
            self._inner = self._gui.add_folder(None)
        known = METHODS.get(method)
        if known is None:
            self._options = None
            return
        begun = {name: value for name, value in self._begun_options.items() if name in known.options.model_fields}
        initial = known.options().model_dump() | begun
        with self._inner:
            self._options = Form(self._gui, known.options, initial, self._words, self._units, touched=self._touched)

    def _asked(self, method: Method) -> Asked:
        draft = self._form.draft
        edge = method in WITH_PASSES and draft["direction"] == Direction.EDGE
        return Asked(draft["field"], edge=edge, exclusions=method in PLANNED)

    def _cards_html(self, chosen: Method) -> str:
        cards = []
        for entry_value, label in _method_labels():
            method = Method(entry_value)
            known = METHODS.get(method)
            if known is None:
                picture = line_picture(self._words)
            else:
                picture = method_picture(known, self._options_of(known, method, chosen), self._words)
            name = html.escape(self._words(label))
            mark = " g-chosen" if method is chosen else ""
            cards.append(f'<div class="g-card{mark}" data-press="{name}">{picture}<span>{name}</span></div>')
        return f'<div class="g-cards">{"".join(cards)}</div>'

    def _options_of(self, known: OperationMethod, method: Method, chosen: Method) -> PatternOptions:
        """As far as they can be read of the form; by default for a method that is not chosen."""
        if method is not chosen or self._options is None:
            return known.options()
        try:
            return known.options_from(self._options.values())
        except PlanError:
            return known.options()

    # --- the document ----------------------------------------------------------------------------------------------

    @property
    def changed(self) -> bool:
        """Whether something was typed."""
        return self._form.changed or self._on_field.changed or (self._options is not None and self._options.changed)

    def say(self, wrong: Mapping[str, str]) -> None:
        """Puts sentences under entries."""
        self._form.say(wrong)

    def read(self) -> Operation | None:
        """The operation; None when something is wrong, which then stands in the form."""
        return self._read({})

    def _read(self, instead: Mapping[str, str]) -> Operation | None:
        entries = self._form.read(instead)
        options = None if self._options is None else self._options.read()
        asked = self._asked(Method(self._form.draft["method"]))
        placed = self._on_field.complete(asked)
        if entries is None or not placed or (self._options is not None and options is None):
            return None
        wrong = {
            member: self._words("A number is missing here.")
            for headland, member in (("laps", "laps"), ("space", "turning_space"))
            if entries.headland == headland and getattr(entries, member) is None
        }
        if wrong:
            self._form.say(wrong)
            return None
        values = entries.model_dump(exclude={"headland"})
        values["laps"] = entries.laps if entries.headland == "laps" else None
        values["turning_space"] = entries.turning_space if entries.headland == "space" else None
        values["options"] = {} if options is None else options.model_dump()
        values |= self._on_field.values(asked)
        if entries.direction is Direction.EDGE and values["edge_at"] is None:
            values["direction"] = Direction.LONGEST_EDGE  # of a method that asks for no direction
        return Operation.model_validate(values)

    # --- the plan --------------------------------------------------------------------------------------------------

    def _show_plan(self) -> None:
        """Plans as a drive would, from the documents as they are stored and the form as it is."""
        operation = self._read({"name": self._words("Operation")})
        store = self._hands.house.store
        if operation is None or store is None or not self._hands.wheel.mine():
            return
        if self._hands.house.driving:
            self._said = self._words("Something is driven now: a plan can be looked at when the drive has ended.")
            self._touched()
            return
        self._said = self._words("Planning …")
        self._touched()
        job = Job(
            tractor=store.load(Tractor, operation.tractor).document,
            implement=store.load(Implement, operation.implement).document,
            receiver=Receiver(name="Receiver"),
            field=store.load(FieldDocument, operation.field).document,
            operation=operation,
            settings=self._hands.house.settings(),
        )
        shown = self._hands.house.show_job(job)
        self._shown_job = job if shown else None
        self._said = ""
        self._hands.look(ViewMode.WHOLE_FIELD)
        self._touched()

    def _plan_html(self, desk: Desk) -> str:
        """Costs and warnings of the plan on the map, while it is that of this form."""
        if self._said or self._shown_job is None or self._hands.house.manager.session.job is not self._shown_job:
            return notice_html([self._said]) if self._said else ""
        snapshot = desk.snapshot
        notices = notice_html(self._words.say(one) for one in snapshot.notices)
        plan = snapshot.plan
        if plan is None:
            return notices
        self._draw(plan)
        return notices + rows_html(plan_cost_rows(plan, self._units, self._words))

    def _draw(self, plan: Plan) -> None:
        """Again when another field begins the scene anew, which takes the strokes away."""
        sketch, drawn = self._hands.sketch, self._drawn_plan
        if drawn is None or drawn[0] is not plan or drawn[1] != sketch.scene_number:
            self._drawn_plan = plan, sketch.scene_number
            draw_plan(sketch, plan.segments)

    def close(self) -> None:
        """The plan's strokes go with the form, and what is marked on the field."""
        self._on_field.close()
        if self._drawn_plan is not None:
            draw_plan(self._hands.sketch, ())

    def show(self, desk: Desk | None = None) -> None:
        """Brings options, pictures and plan up to what was touched."""
        method = Method(self._form.draft["method"])
        if method is not self._method:
            self._open_options(method)
        self._form.show()
        if self._options is not None:
            self._options.show()
        drawn = (method, None if self._options is None else self._options.draft)
        if drawn != self._drawn:
            self._drawn = drawn
            self._cards.show(self._cards_html(method))
        known = METHODS.get(method)
        about = (
            self._words("Passes beside a first straight stretch; nothing is planned.")
            if known is None
            else self._words(known.explanation)
        )
        self._about.show(f'<div class="g-said">{html.escape(about)}</div>')
        self._on_field.show(self._asked(method), desk)
        if desk is not None:
            self._plan.show(self._plan_html(desk))


def _with_headland(initial: Mapping[str, Any]) -> dict[str, Any]:
    """The values of an operation, with how its headland was asked for."""
    headland = "laps" if initial.get("laps") is not None else "needed"
    if headland == "needed" and initial.get("turning_space") is not None:
        headland = "space"
    return {**initial, "headland": headland}


def _method_labels() -> tuple[tuple[str, str], ...]:
    extra = Operation.model_fields["method"].json_schema_extra
    assert isinstance(extra, dict), "the method is a choice"
    labels = extra["labels"]
    assert isinstance(labels, dict), "a choice has labels"
    return tuple((str(value), str(label)) for value, label in labels.items())
