"""What ``guidance-app plan`` may be asked for, as options, and the request that they make for one field."""

import argparse
import math
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from guidance_app.boundary import frame_of
from guidance_app.commands.options import UseError
from guidance_app.documents import Direction, FieldDocument, Method, Position
from guidance_app.guidance.request import LastPass, PlanError, PlanRequest
from guidance_app.guidance.wishes import edge_place, line_places
from guidance_app.language import sentence

__all__ = ["add_plan_options", "is_about_one_field", "request_for"]

METHODS = [method.value for method in Method if method is not Method.LINE]
CORNERS = ["nearest", "first-left", "first-right", "last-left", "last-right"]
ALL = "all"


def add_plan_options(parser: argparse.ArgumentParser) -> None:
    """Machine, method, direction and what else a plan can be asked for."""
    parser.add_argument("--width", type=_number, required=True, metavar="METRES", help="working width")
    parser.add_argument("--radius", type=_number, required=True, metavar="METRES", help="turning radius")
    parser.add_argument("--method", choices=METHODS, default=Method.ROUND_TRIP.value, help="how the passes are driven")
    parser.add_argument(
        "--option",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="an option of the method, as skip=2; may be given again",
    )
    parser.add_argument("--overlap", type=_number, default=0.0, metavar="METRES", help="of neighbouring passes")
    parser.add_argument("--laps", type=int, metavar="N", help="headland laps (default: as many as a turn needs)")
    parser.add_argument("--turning-space", type=_number, metavar="METRES", help="depth of the headland instead of laps")
    parser.add_argument("--laps-first", action="store_true", help="drive the headland before the passes")
    parser.add_argument("--anticlockwise", action="store_true", help="drive the laps the other way round")
    parser.add_argument(
        "--direction",
        default=Direction.LONGEST_EDGE.value,
        metavar="DEG|best|longest-edge|edge:LON,LAT|line[:NAME]",
        help="of the passes: degrees from north, found, along the edge nearest to a place, or along a guidance line"
        " that the field holds",
    )
    parser.add_argument("--start", type=_place, metavar="LON,LAT", help="where the tractor comes from")
    parser.add_argument("--start-corner", choices=CORNERS, default="nearest", help="where the first pass begins")
    parser.add_argument("--exit", type=_place, metavar="LON,LAT", help="where the tractor leaves")
    last = [one.value for one in LastPass]
    parser.add_argument("--last-pass", choices=last, default=last[0], help="what becomes of a rest")
    parser.add_argument(
        "--passable",
        type=_numbers,
        default=(),
        metavar="all|N,N...",
        help="exclusions to drive and work over, counted from 1 (default: drive around each)",
    )
    parser.add_argument("--no-reverse", action="store_true", help="the tractor does not back up in a turn")


def is_about_one_field(arguments: argparse.Namespace) -> bool:
    """Whether an option names places of one field, so that a folder of fields makes no sense."""
    numbers = bool(arguments.passable) and arguments.passable != ALL
    places = arguments.start is not None or arguments.exit is not None
    return numbers or places or arguments.direction.startswith("edge:")


def request_for(arguments: argparse.Namespace, field: FieldDocument) -> PlanRequest:
    """The request for one field. Raises ``PlanError`` or ``UseError``."""
    frame = frame_of(field.boundary)

    def placed(place: Position | None) -> tuple[float, float] | None:
        return None if place is None else frame.east_north_from_degrees(place[1], place[0])

    over = _passable(arguments, field)
    chosen = _direction(arguments.direction)
    line = edge = None
    if chosen.line is not None:
        line = line_places(field, chosen.line, frame)
    if chosen.edge is not None:
        edge = edge_place(field, chosen.edge, frame, over)
    return PlanRequest(
        width=arguments.width,
        overlap=arguments.overlap,
        radius=arguments.radius,
        method=Method(arguments.method),
        options=MappingProxyType(dict(_option(one) for one in arguments.option)),
        laps=arguments.laps,
        turning_space=arguments.turning_space,
        direction=chosen.kind,
        heading=chosen.heading,
        line=line,
        edge_near=edge,
        start=placed(arguments.start),
        start_corner=arguments.start_corner,
        exit=placed(arguments.exit),
        laps_first=arguments.laps_first,
        laps_clockwise=not arguments.anticlockwise,
        reverse_allowed=not arguments.no_reverse,
        last_pass=LastPass(arguments.last_pass),
        passable=over,
    )


def _passable(arguments: argparse.Namespace, field: FieldDocument) -> frozenset[int]:
    count = len(field.boundary.coordinates) - 1
    if arguments.passable == ALL:
        return frozenset(range(count))
    wrong = [number for number in arguments.passable if not 1 <= number <= count]
    if wrong:
        msg = sentence(
            "there is no exclusion {number} in '{field}': it has {count}",
            number=wrong[0],
            field=field.name,
            count=count,
        )
        raise PlanError(msg)
    return frozenset(number - 1 for number in arguments.passable)


@dataclass(frozen=True, slots=True)
class _Direction:
    kind: Direction
    heading: float | None = None
    edge: Position | None = None
    line: str | None = None


def _direction(text: str) -> _Direction:
    if text in {Direction.BEST.value, Direction.LONGEST_EDGE.value}:
        return _Direction(Direction(text))
    kind, _, rest = text.partition(":")
    if kind == Direction.LINE.value:
        return _Direction(Direction.LINE, line=rest)
    try:
        if kind == Direction.EDGE.value:
            return _Direction(Direction.EDGE, edge=_place(rest))
        degrees = float(text.replace(",", "."))
    except (ValueError, argparse.ArgumentTypeError):
        degrees = math.nan
    if not math.isfinite(degrees):
        msg = f"--direction is {text!r}: give degrees from north, best, longest-edge, edge:LON,LAT or line:NAME"
        raise UseError(msg)
    return _Direction(Direction.TYPED, heading=math.radians(degrees % 360.0))


def _option(text: str) -> tuple[str, float | int | str | bool]:
    name, equals, value = text.partition("=")
    if not equals or not name:
        msg = f"--option is {text!r}: write it as NAME=VALUE, as in skip=2"
        raise UseError(msg)
    known: dict[str, Any] = {"true": True, "false": False}
    if value.lower() in known:
        return name, bool(known[value.lower()])
    for kind in (int, float):
        try:
            return name, kind(value)
        except ValueError:
            continue
    return name, value


def _number(text: str) -> float:
    try:
        return float(text.replace(",", "."))
    except ValueError:
        msg = f"{text!r} is not a number of metres"
        raise argparse.ArgumentTypeError(msg) from None


def _place(text: str) -> Position:
    try:
        longitude, latitude = (float(part) for part in text.split(","))
    except ValueError:
        longitude = latitude = math.nan
    if not (abs(longitude) <= 180 and abs(latitude) <= 89):
        msg = f"{text!r} is no place: write longitude and latitude in degrees, as in 8.5,47.5"
        raise argparse.ArgumentTypeError(msg)
    return longitude, latitude


def _numbers(text: str) -> tuple[int, ...] | str:
    if text == ALL:
        return ALL
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        msg = f"{text!r} names no exclusions: write all, or their numbers as in 1,3"
        raise argparse.ArgumentTypeError(msg) from None
