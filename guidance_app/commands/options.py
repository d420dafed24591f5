"""What several sub-commands share: common options, and the errors that become one line."""

import argparse
import os
from pathlib import Path

from pydantic import ValidationError

from guidance_app.bench.errors import BenchError
from guidance_app.boundary import BoundaryError
from guidance_app.console.address import ConsoleError
from guidance_app.documents import FieldDocument, Implement, Job, Method, Operation, Receiver, Tractor
from guidance_app.estimation.filter import FilterSettings
from guidance_app.estimation.filters import FILTERS
from guidance_app.exchange import ExchangeError
from guidance_app.guidance.planning import PlanError
from guidance_app.runtime import Comparison
from guidance_app.sources import SourceError
from guidance_app.store import StoreError, data_folder, field_from_file, simulated_notice

__all__ = [
    "UseError",
    "add_compare_options",
    "add_console_options",
    "add_data_option",
    "add_filter_option",
    "add_job_options",
    "chosen_data_folder",
    "comparison",
    "filter_settings",
    "job_from_options",
    "known_errors",
    "notices_of",
    "refuse_documents",
    "replay_speed",
]

DEFAULT_PORT = 8080
DEFAULT_WIDTH = 3.0


class UseError(ValueError):
    """The command line asks for something that cannot be; the message is one sentence."""


def known_errors() -> tuple[type[Exception], ...]:
    """Errors whose message is a sentence for the person at the terminal; each ends the command with status 2."""
    return (UseError, SourceError, StoreError, ConsoleError, PlanError, ExchangeError, BoundaryError, BenchError)


def add_data_option(parser: argparse.ArgumentParser) -> None:
    """``--data``."""
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        help="data folder (else GUIDANCE_DATA, else fields/ of the checkout, else the user's data directory)",
    )


def chosen_data_folder(arguments: argparse.Namespace) -> Path:
    """The data folder of a command line. Raises ``StoreError``."""
    return data_folder(arguments.data, os.environ)


def add_console_options(parser: argparse.ArgumentParser) -> None:
    """``--port`` and ``--lan``."""
    parser.add_argument(
        "--port", type=_port, default=DEFAULT_PORT, help=f"port of the page (default {DEFAULT_PORT}; 0: any free one)"
    )
    parser.add_argument(
        "--lan", action="store_true", help="let tablets in the same network open the page; asks them for a PIN"
    )


def add_filter_option(parser: argparse.ArgumentParser) -> None:
    """``--filter``."""
    parser.add_argument("--filter", choices=sorted(FILTERS), metavar="NAME", help=", ".join(FILTERS))
    parser.add_argument(
        "--settings", type=Path, metavar="FILE", help="filter settings, as guidance-app tune writes them"
    )


def filter_settings(path: Path | None) -> FilterSettings | None:
    """The filter settings of a file; None without one. Raises ``UseError`` that names field, value and bound."""
    if path is None:
        return None
    try:
        return FilterSettings.model_validate_json(path.read_bytes())
    except OSError as error:
        msg = f"the filter settings {path} cannot be read: {error.strerror}"
        raise UseError(msg) from error
    except ValidationError as error:
        first = error.errors()[0]
        if first["type"] == "json_invalid":
            msg = f"the filter settings {path} are no whole JSON document: {first['ctx']['error']}"
            raise UseError(msg) from error
        where = ".".join(str(part) for part in first["loc"]) or "the document"
        msg = f"the filter settings {path} are refused: {where} is {first['input']!r}, {first['msg'].lower()}"
        raise UseError(msg) from error


def add_job_options(parser: argparse.ArgumentParser) -> None:
    """``--field``, ``--width`` and ``--filter``."""
    parser.add_argument(
        "--field", type=Path, metavar="FILE", help="field as GeoJSON or as a document of the data folder"
    )
    parser.add_argument(
        "--width", type=_width, metavar="METRES", help=f"working width in metres (default {DEFAULT_WIDTH:g})"
    )
    add_filter_option(parser)


def job_from_options(arguments: argparse.Namespace) -> Job:
    """The job of ``--field`` and ``--width``: a field is planned as a round trip, without one a line is looked for.

    Raises ``StoreError`` for a field that cannot be used.
    """
    field: FieldDocument | None = None if arguments.field is None else field_from_file(arguments.field)
    tractor = Tractor(name="Tractor", antenna_height=0.0)
    width = DEFAULT_WIDTH if arguments.width is None else arguments.width
    implement = Implement(name="Implement", working_width=width, offset_back=0.0, length=1.0)
    operation = None
    if field is not None:
        operation = Operation(
            name="Round trip",
            field=field.name,
            tractor=tractor.name,
            implement=implement.name,
            method=Method.ROUND_TRIP,
        )
    return Job(tractor=tractor, implement=implement, receiver=_receiver(arguments), field=field, operation=operation)


def _receiver(arguments: argparse.Namespace) -> Receiver:
    """The receiver of ``--source`` and ``--attitude``, where the sub-command has them."""
    source = getattr(arguments, "source", None)
    attitude = getattr(arguments, "attitude", None)
    if source is None:
        return Receiver(name="Receiver")
    try:
        return Receiver(name="Receiver", source=source, attitude_source=attitude)
    except ValidationError as error:
        msg = f"the receiver's address is refused: {error.errors()[0]['msg'].lower()}"
        raise UseError(msg) from error


def add_compare_options(parser: argparse.ArgumentParser) -> None:
    """``--compare-filter``, ``--compare-look-ahead`` and ``--compare-antenna``."""
    group = parser.add_argument_group("a second engine beside, whose track is shown as a ghost")
    group.add_argument("--compare-filter", choices=sorted(FILTERS), metavar="NAME", help="with another filter")
    group.add_argument(
        "--compare-look-ahead", type=float, metavar="SECONDS", help="with another look-ahead, 0.5 to 3 s"
    )
    group.add_argument(
        "--compare-antenna",
        type=float,
        nargs=3,
        metavar=("FORWARD", "RIGHT", "HEIGHT"),
        help="with the antenna in another place, metres from the middle of the rear axle",
    )


def comparison(arguments: argparse.Namespace, job: Job) -> Comparison | None:
    """What the second engine has else; None without one. Raises ``UseError`` for what documents cannot hold."""
    antenna = None if arguments.compare_antenna is None else tuple(arguments.compare_antenna)
    if arguments.compare_filter is None and arguments.compare_look_ahead is None and antenna is None:
        return None
    made = Comparison(arguments.compare_filter, None, arguments.compare_look_ahead, antenna)
    try:
        made.job_of(job)
    except ValidationError as error:
        first = error.errors()[0]
        msg = f"nothing to compare with: {first['loc'][0]} is {first['input']!r}, {first['msg'].lower()}"
        raise UseError(msg) from error
    return made


def refuse_documents(arguments: argparse.Namespace, *others: str) -> None:
    """A recording brings its own documents. Raises ``UseError`` where the command line names some, or ``others``."""
    for name in ("field", "width", *others):
        if getattr(arguments, name) is not None:
            msg = f"a recording has its own documents and settings: leave --{name} out"
            raise UseError(msg)


def notices_of(log: Path) -> tuple[str, ...]:
    """What the console must say of a recording: that it is simulated, when it is."""
    notice = simulated_notice(log)
    return () if notice is None else (notice,)


def replay_speed(text: str) -> float:
    """``0.5`` to ``50``, or ``max``."""
    if text.strip().lower() == "max":
        return float("inf")
    return _number(text, "speed", 0.5, 50.0)


def _width(text: str) -> float:
    return _number(text, "working width in metres", 0.3, 60.0)


def _number(text: str, what: str, low: float, high: float) -> float:
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        msg = f"{text!r} is not a number; a {what} goes from {low:g} to {high:g}"
        raise argparse.ArgumentTypeError(msg) from None
    if not low <= value <= high:
        msg = f"{text} is out of bounds; a {what} goes from {low:g} to {high:g}"
        raise argparse.ArgumentTypeError(msg)
    return value


def _port(text: str) -> int:
    return int(_whole(text, "port", 0, 65535))


def _whole(text: str, what: str, low: int, high: int) -> int:
    try:
        value = int(text)
    except ValueError:
        msg = f"{text!r} is not a whole number; a {what} goes from {low} to {high}"
        raise argparse.ArgumentTypeError(msg) from None
    if not low <= value <= high:
        msg = f"{text} is out of bounds; a {what} goes from {low} to {high}"
        raise argparse.ArgumentTypeError(msg)
    return value
