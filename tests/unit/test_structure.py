"""The house rules that a machine can hold: sizes, cycles, and tables that name every plug-in of their folder."""

import ast
import importlib
import pkgutil
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import guidance_app

PACKAGE = Path(guidance_app.__file__).parent
SOURCES = sorted(PACKAGE.rglob("*.py"))
LONGEST_FILE, LONGEST_FUNCTION = 400, 60


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_files_and_functions_fit_in_a_look(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") <= LONGEST_FILE
    functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    too_long = [one.name for one in functions if one.end_lineno - one.lineno + 1 > LONGEST_FUNCTION]
    assert not too_long


def _module_name(path: Path) -> str:
    parts = ("guidance_app", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imports(path: Path, known: frozenset[str]) -> set[str]:
    """Modules of this package that a file imports, type-checking imports aside."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    guarded = {
        inner
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    found = set()
    for node in ast.walk(tree):
        if node in guarded or not isinstance(node, ast.ImportFrom) or node.module is None:
            continue
        for alias in node.names:
            inner = f"{node.module}.{alias.name}"
            found.add(inner if inner in known else node.module)
    return found & known


def test_no_import_cycle() -> None:
    known = frozenset(_module_name(path) for path in SOURCES)
    graph = {_module_name(path): _imports(path, known) - {_module_name(path)} for path in SOURCES}
    assert len(list(TopologicalSorter(graph).static_order())) >= len(known)


def _modules_in(package: str) -> set[str]:
    folder = importlib.import_module(package)
    return {info.name for info in pkgutil.iter_modules(folder.__path__)}


@pytest.mark.parametrize(
    ("package", "shared"),
    [
        ("guidance_app.commands", {"options", "plan_options", "serving"}),
        ("guidance_app.sources", {"addresses", "baud", "kept", "merged", "ntrip", "pacing", "ports"}),
        ("guidance_app.estimation.filters", set()),
        ("guidance_app.guidance.patterns", set()),
        ("guidance_app.console.panels", set()),
        ("guidance_app.exchange.drives", {"record"}),
        (
            "guidance_app.exchange",
            {"asking", "corner_table", "drives", "files", "rings", "time_log", "time_log_drive", "xml_tree"},
        ),
    ],
)
def test_every_plug_in_stands_in_its_folders_table(package: str, shared: set[str]) -> None:
    table = importlib.import_module(package)
    text = Path(table.__file__).read_text(encoding="utf-8")
    plug_ins = _modules_in(package) - shared
    assert plug_ins, f"{package} has no plug-in at all"
    forgotten = {name for name in plug_ins if name not in text}
    assert not forgotten, f"{package}: {sorted(forgotten)} not in the table"
