"""The messages that stand in source text, found by its syntax tree: what the catalogues have to hold.

Babel's own extractor does not see keyword arguments, and a form's titles and help are keyword arguments. A message must
be a literal where it is marked; a pattern put together there could never be found in a catalogue.
"""

import ast
import string
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

__all__ = ["ExtractionError", "Message", "messages_in", "places_of"]

WORDS = frozenset({"words", "_words"})
"""Names by which a ``Words`` is called, alone or behind a point."""

POSITIONAL: Mapping[str, int] = {"message": 1, "sentence": 1, "quantity": 1, "choice": 1}
"""Functions whose first arguments are messages, and how many."""

KEYWORDS: Mapping[str, frozenset[str]] = {
    "quantity": frozenset({"title", "help"}),
    "choice": frozenset({"title", "help"}),
    "Field": frozenset({"title", "description"}),
}
"""Functions some of whose keyword arguments are messages."""


class ExtractionError(Exception):
    """A message is marked that is not a literal."""


@dataclass(frozen=True, slots=True)
class Message:
    """One message: what it is in English, for one and for many, and what tells it from its namesakes."""

    text: str
    many: str | None = None
    context: str | None = None


def messages_in(source: str, name: str) -> list[Message]:
    """Every message of a module, in its order. ``name`` is for the error alone."""
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    try:
        return [one for call in calls for one in _of_call(call) if one.text]
    except ExtractionError as error:
        msg = f"{name}, {error}"
        raise ExtractionError(msg) from None


def places_of(text: str) -> frozenset[str]:
    """The names in braces; empty braces and formats too, so that a translation keeps them as they are."""
    return frozenset(f"{name}:{spec}" for _, name, spec, _ in string.Formatter().parse(text) if name is not None)


def _of_call(call: ast.Call) -> Iterator[Message]:
    function = _name(call.func)
    if function in WORDS and call.args:
        for text in _literals(call.args[0]):
            yield Message(text)
    elif isinstance(call.func, ast.Attribute) and _name(call.func.value) in WORDS:
        yield from _of_method(call, call.func.attr)
    for argument in call.args[: POSITIONAL.get(function, 0)]:
        for text in _literals(argument):
            yield Message(text)
    for keyword in call.keywords:
        if keyword.arg in KEYWORDS.get(function, ()):
            for text in _literals(keyword.value):
                yield Message(text)


def _of_method(call: ast.Call, method: str) -> Iterator[Message]:
    if method == "plural":
        yield Message(_literal(call.args[0]), many=_literal(call.args[1]))
    elif method == "within":
        for text in _literals(call.args[1]):
            yield Message(text, context=_literal(call.args[0]))


def _name(node: ast.expr) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def _literal(node: ast.expr) -> str:
    texts = list(_literals(node))
    if len(texts) != 1:
        msg = f"line {node.lineno}: the message is not written out here"
        raise ExtractionError(msg)
    return texts[0]


def _literals(node: ast.expr) -> Iterator[str]:
    """The text, or both of a choice. A name is let through: what it stands for is marked elsewhere."""
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.IfExp(body=body, orelse=other):
            yield from _literals(body)
            yield from _literals(other)
        case ast.JoinedStr() | ast.BinOp():
            msg = f"line {node.lineno}: a message cannot be put together here; give its values by name"
            raise ExtractionError(msg)
