"""Any command of the vocabulary, made from its record alone."""

import enum
import types
import typing
from dataclasses import fields
from typing import Any

from hypothesis import strategies as st

from guidance_app.model import Chunk, Command, Commanded, Event, SourceDown, SourceUp

COMMAND_KINDS: tuple[type, ...] = typing.get_args(Command)

NUMBERS = {bool: st.booleans(), int: st.integers(1, 64), float: st.floats(0.5, 3.0), str: st.text(max_size=20)}
"""Within what every command allows."""


def values_of(hint: Any) -> st.SearchStrategy[Any]:
    """Values of a member's type."""
    if isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union:
        return st.one_of(*(values_of(one) for one in typing.get_args(hint)))
    if hint is type(None):
        return st.none()
    if isinstance(hint, type) and issubclass(hint, enum.Enum):
        return st.sampled_from(list(hint))
    if hint in NUMBERS:
        return NUMBERS[hint]
    return st.from_type(hint)


def commands_of(kind: type) -> st.SearchStrategy[Command]:
    """Commands of this kind; what its own rule refuses is left out."""
    hints = typing.get_type_hints(kind)
    members = st.fixed_dictionaries({one.name: values_of(hints[one.name]) for one in fields(kind)})
    made = members.map(lambda values: _made(kind, values))
    return made.filter(lambda one: one is not None)


def _made(kind: type, values: dict[str, Any]) -> Any:
    try:
        return kind(**values)
    except ValueError:
        return None


def events() -> st.SearchStrategy[Event]:
    """Any input of an engine, with any bytes and times."""
    times = st.floats(-1e3, 1e6)
    texts = st.text(max_size=30)
    return st.one_of(
        st.builds(Chunk, times, st.binary(max_size=60), texts),
        st.builds(Commanded, times, st.one_of(*(commands_of(kind) for kind in COMMAND_KINDS))),
        st.builds(SourceUp, times, texts, texts),
        st.builds(SourceDown, times, texts, texts, st.booleans()),
    )
