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
from guidance_app.sources import SourceError
from guidance_app.store import StoreError, data_folder, field_from_file, simulated_notice

__all__ = [
    "UseError",
    "add_console_options",
    "add_data_option",
    "add_filter_option",
    "add_job_options",
    "chosen_data_folder",
    "filter_settings",
    "job_from_options",
    "known_errors",
    "notices_of",
    "replay_speed",
]

DEFAULT_PORT = 8080


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
        where = ".".join(str(part) for part in first["loc"]) or "the document"
        msg = f"the filter settings {path} are refused: {where} is {first['input']!r}, {first['msg'].lower()}"
        raise UseError(msg) from error


def add_job_options(parser: argparse.ArgumentParser) -> None:
    """``--field``, ``--width`` and ``--filter``."""
    parser.add_argument(
        "--field", type=Path, metavar="FILE", help="field as GeoJSON or as a document of the data folder"
    )
    parser.add_argument(
        "--width", type=_width, default=3.0, metavar="METRES", help="working width in metres (default 3)"
    )
    add_filter_option(parser)


def job_from_options(arguments: argparse.Namespace) -> Job:
    """The job of ``--field`` and ``--width``: a field is planned as a round trip, without one a line is looked for.

    Raises ``StoreError`` for a field that cannot be used.
    """
    field: FieldDocument | None = None if arguments.field is None else field_from_file(arguments.field)
    tractor = Tractor(name="Tractor", antenna_height=0.0)
    implement = Implement(name="Implement", working_width=arguments.width, offset_back=0.0, length=1.0)
    operation = None
    if field is not None:
        operation = Operation(
            name="Round trip",
            field=field.name,
            tractor=tractor.name,
            implement=implement.name,
            method=Method.ROUND_TRIP,
        )
    return Job(
        tractor=tractor, implement=implement, receiver=Receiver(name="Receiver"), field=field, operation=operation
    )


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
