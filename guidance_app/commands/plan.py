"""``guidance-app plan``: a field's passes at the desk, as JSON, GeoJSON or a picture; a folder of fields in one go."""

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from guidance_app.batch.plans import plan_as_geojson, plan_as_json
from guidance_app.boundary import frame_of, polygon_in
from guidance_app.commands.options import UseError
from guidance_app.commands.plan_options import add_plan_options, is_about_one_field, request_for
from guidance_app.documents import FieldDocument
from guidance_app.geodesy import FieldFrame
from guidance_app.guidance.planning import PlanError, plan_operation
from guidance_app.model import Plan
from guidance_app.store import StoreError, field_from_file
from guidance_app.store.files import write_atomically

__all__ = ["add_parser", "run"]

PICTURES = {".png", ".svg"}
DOCUMENTS = {".json", ".geojson"}


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describes the sub-command."""
    parser = subparsers.add_parser(
        "plan",
        help="plan a field's passes at the desk",
        description="Plans the passes of one field, or of every field in a folder. With --out the plan is written as"
        " JSON, GeoJSON or, with the figures extra, as a picture; a folder gives one picture of all plans.",
    )
    parser.add_argument("field", type=Path, metavar="FIELD", help="GeoJSON, a field document, or a folder of them")
    add_plan_options(parser)
    parser.add_argument("--out", type=Path, metavar="FILE", help=".json, .geojson, .png or .svg")
    parser.add_argument("--json", action="store_true", help="print the plan (of a folder: its costs) as JSON")
    parser.set_defaults(func=run)


def run(arguments: argparse.Namespace) -> int:
    """Plans one field, or all of a folder; of a folder, fields that cannot be planned are named and left out."""
    _check_out(arguments)
    if arguments.field.is_dir():
        return _plan_folder(arguments)
    field, frame, plan, seconds = _planned(arguments.field, arguments)
    document = plan_as_json(plan, frame, seconds)
    if arguments.out is not None:
        _write(arguments.out, field, frame, plan, seconds)
    print(json.dumps(document) if arguments.json else _in_words(field.name, document))
    return 0


def _planned(path: Path, arguments: argparse.Namespace) -> tuple[FieldDocument, FieldFrame, Plan, float]:
    field = field_from_file(path)
    request = request_for(arguments, field)
    frame = frame_of(field.boundary)
    begin = time.process_time()
    plan = plan_operation(polygon_in(frame, field.boundary), request)
    return field, frame, plan, time.process_time() - begin


def _plan_folder(arguments: argparse.Namespace) -> int:
    if is_about_one_field(arguments):
        msg = "places and numbers of exclusions belong to one field: name its file instead of a folder"
        raise UseError(msg)
    if arguments.out is not None and arguments.out.suffix.lower() in DOCUMENTS:
        msg = f"{arguments.out}: a folder of fields is written as a picture (.png, .svg), not as a document"
        raise UseError(msg)
    made = []
    rows: list[dict[str, Any]] = []
    for path, outcome in _each(arguments):
        if isinstance(outcome, str):
            rows.append({"field": path.name, "error": outcome})
            continue
        field, frame, plan, seconds = outcome
        document = plan_as_json(plan, frame, seconds)
        rows.append(
            {"field": path.name, "costs": document["costs"], "warnings": document["warnings"], "cpu_s": seconds}
        )
        made.append((path.stem, field, frame, plan))
    if not rows:
        msg = f"{arguments.field} holds no .geojson or .json field"
        raise UseError(msg)
    if arguments.out is not None:
        _write_gallery(arguments.out, made)
    print(json.dumps(rows) if arguments.json else "\n".join(_row_in_words(row) for row in rows))
    return 0


def _each(
    arguments: argparse.Namespace,
) -> Iterator[tuple[Path, str | tuple[FieldDocument, FieldFrame, Plan, float]]]:
    for path in sorted(one for one in arguments.field.iterdir() if one.suffix.lower() in DOCUMENTS):
        try:
            yield path, _planned(path, arguments)
        except (StoreError, PlanError) as error:
            yield path, str(error)


def _check_out(arguments: argparse.Namespace) -> None:
    out = arguments.out
    if out is not None and out.suffix.lower() not in PICTURES | DOCUMENTS:
        msg = f"{out}: a plan is written as .json, .geojson, .png or .svg"
        raise UseError(msg)


def _write(out: Path, field: FieldDocument, frame: FieldFrame, plan: Plan, seconds: float) -> None:
    match out.suffix.lower():
        case ".json":
            write_atomically(out, json.dumps(plan_as_json(plan, frame, seconds)).encode())
        case ".geojson":
            write_atomically(out, json.dumps(plan_as_geojson(plan, frame)).encode())
        case _:
            _write_gallery(out, [(field.name, field, frame, plan)])


def _write_gallery(out: Path, made: list[tuple[str, FieldDocument, FieldFrame, Plan]]) -> None:
    try:
        from guidance_app.batch.plan_picture import picture_of_plans  # noqa: PLC0415 - the figures extra
    except ModuleNotFoundError as error:
        msg = f"pictures need {error.name}: install guidance-app with its extra 'figures'"
        raise UseError(msg) from error
    shown = [(title, polygon_in(frame, field.boundary), plan) for title, field, frame, plan in made]
    write_atomically(out, picture_of_plans(shown, out.suffix.lower().removeprefix(".")))


def _in_words(name: str, document: dict[str, Any]) -> str:
    costs = document["costs"]
    lines = [
        f"{name}: {costs['turns']} turns, {costs['minutes']:.0f} min",
        f"driven at work {costs['work_m']:.0f} m, not at work {costs['idle_m']:.0f} m",
        f"worked {100 * costs['worked_fraction']:.1f} % of the field, {100 * costs['overlap_fraction']:.1f} % twice",
    ]
    return "\n".join([*lines, *(f"warning: {warning}" for warning in document["warnings"])])


def _row_in_words(row: dict[str, Any]) -> str:
    if "error" in row:
        return f"{row['field']}: no plan: {row['error']}"
    costs = row["costs"]
    return (
        f"{row['field']}: {costs['turns']} turns, {costs['minutes']:.0f} min,"
        f" worked {100 * costs['worked_fraction']:.1f} %, twice {100 * costs['overlap_fraction']:.1f} %"
    )
