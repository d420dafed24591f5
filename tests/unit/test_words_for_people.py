"""What the screen shows is marked for the catalogues, where a machine can see that it is shown.

Two kinds of literals are found in ``view/`` and ``console/``: any text handed to a widget or set as a label, and any
text of more than one word. Not meant for people are docstrings, errors of a programmer, the log, and HTML.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import guidance_app
from guidance_app.language.extraction import KEYWORDS, POSITIONAL, WORDS

PACKAGE = Path(guidance_app.__file__).parent
SHOWING = sorted([*(PACKAGE / "view").rglob("*.py"), *(PACKAGE / "console").rglob("*.py")])

MARKED = {*POSITIONAL, *KEYWORDS, *WORDS}
SILENT = {"debug", "info", "warning", "error", "exception", "ConsoleError", "RuntimeError", "ValueError", "TypeError"}
"""The log, and errors that the terminal or a programmer reads."""

WIDGETS = re.compile(r"add_(button|button_group|checkbox|dropdown|folder|markdown|number|slider|tab|text|vector\d)$")
"""viser's makers of widgets, whose first argument and hint are shown."""
OWN_WIDGETS = {"Choice", "buttons", "Figure", "tell", "link_html", "upload_html", "words_html"}
UNSEEN = {"row "}
"""The name of a button whose place a row of a table takes."""
SHOWN_ATTRIBUTES = {"label", "hint", "placeholder"}

LETTERS = re.compile(r"^(?!\.).*[^\W\d_]{2}", re.DOTALL)
"""Endings of files are for the browser."""
TWO_WORDS = re.compile(r"[^\W\d_]{2,}[,.:;]? +[^\W\d_]{2,}")

FOR_MACHINES = {
    "console/server.py": "the invitation at the terminal",
    "console/access.py": "what a foreign page gets instead of the console",
    "console/address.py": "the terminal's own errors",
    "console/guard.py": "plain answers without a page, and a page that is left at once",
    "console/front.py": "HTML of the page's head, and plain answers without a page",
    "console/widgets.py": "styles",
    "console/inner.py": "the log's own words",
    "console/moving.py": "names of scene nodes",
}
"""Files whose longer literals are for the terminal, a program or the browser; their widgets are looked at as well."""


def _name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _texts(node: ast.AST) -> Iterator[tuple[int, str]]:
    """Literal text below a node, except where it is marked, logged, compared with, or a member's value or key."""
    if isinstance(node, ast.Call) and (_name(node.func) in MARKED | SILENT or _on_words(node.func)):
        return
    if isinstance(node, ast.Compare | ast.Raise | ast.Assert | ast.Subscript):
        return
    if isinstance(node, ast.ClassDef) and any(_name(base) == "StrEnum" for base in node.bases):
        return
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.lineno, node.value
    for inner in _values(node) if isinstance(node, ast.Dict) else ast.iter_child_nodes(node):
        yield from _texts(inner)


def _values(table: ast.Dict) -> Iterator[ast.expr]:
    """The values of a table, except those that a marked key names for the program."""
    for key, value in zip(table.keys, table.values, strict=True):
        if not (isinstance(key, ast.Call) and _name(key.func) in MARKED):
            yield value


def _on_words(function: ast.expr) -> bool:
    """``words.plural(...)`` and its like."""
    return isinstance(function, ast.Attribute) and _name(function.value) in WORDS


def _docstrings(tree: ast.Module) -> set[tuple[int, str]]:
    bare = (node.value for node in ast.walk(tree) if isinstance(node, ast.Expr))
    return {(one.lineno, one.value) for one in bare if isinstance(one, ast.Constant) and isinstance(one.value, str)}


def _programmers(tree: ast.Module) -> set[tuple[int, str]]:
    """``msg = ...``: raised in the next line."""
    return {
        found
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and [_name(target) for target in node.targets] == ["msg"]
        for found in _texts(node.value)
    }


def _shown(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Literals of widgets and labels that are not marked."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and (WIDGETS.fullmatch(_name(node.func)) or _name(node.func) in OWN_WIDGETS):
            seen = node.args if _name(node.func) in OWN_WIDGETS else node.args[:1]
            for argument in [*seen, *(one.value for one in node.keywords if one.arg in SHOWN_ATTRIBUTES)]:
                yield from _texts(argument)
        elif isinstance(node, ast.Assign) and any(_name(target) in SHOWN_ATTRIBUTES for target in node.targets):
            yield from _texts(node.value)


def unmarked(source: str, *, sentences: bool = True) -> list[str]:
    """The literals of a module that people would read in English whatever their language, each with its line."""
    tree = ast.parse(source)
    silent = _docstrings(tree) | _programmers(tree)
    found = {(line, text) for line, text in _shown(tree) if LETTERS.search(text) and text not in UNSEEN}
    if sentences:
        found |= {(line, text) for line, text in _texts(tree) if TWO_WORDS.search(text) and not _is_code(text)}
    return [f"line {line}: {text!r}" for line, text in sorted(found - silent)]


def _is_code(text: str) -> bool:
    return any(sign in text for sign in "<>{}=;")


@pytest.mark.parametrize("path", SHOWING, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_what_is_shown_is_marked(path: Path) -> None:
    name = path.relative_to(PACKAGE).as_posix()
    assert not unmarked(path.read_text("utf-8"), sentences=name not in FOR_MACHINES)


@pytest.mark.parametrize(
    "line",
    [
        'gui.add_button("Start")',
        'gui.add_button(words("Start"), hint="Begins")',
        'gui.add_text(f"Name of {kind}", "")',
        'self._end.label = "End" if sure else words("Stay")',
        'buttons(gui, "", (("Undo", undo), (words("Done"), done)))',
        'rows = [("Last data", value)]',
        'hands.tell("Done")',
        'reason = f"no position for {age}"',
    ],
)
def test_an_unmarked_literal_is_found(line: str) -> None:
    assert unmarked(line)


@pytest.mark.parametrize(
    "line",
    [
        'gui.add_button(words("Start"), color="gray", hint=words("Begins it"))',
        'gui.add_slider(hands.words("Look ahead"), 0, 1, 0.1, 0)',
        'self._end.label = self._words("End the drive" if sure else "Drive on")',
        'TABLE = {Kind.ONE: message("one of them")}',
        'TABLE = {message("one of them"): "first kind"}',
        'words.plural("{n} try left", "{n} tries left", n)',
        'msg = "a panel needs a session"\nraise ValueError(msg)',
        'log.warning("the page has gone")',
        '"""Says what is there."""',
        'page = "<p>two words</p>"',
    ],
)
def test_what_is_marked_or_not_for_people_is_let_through(line: str) -> None:
    assert not unmarked(line)
