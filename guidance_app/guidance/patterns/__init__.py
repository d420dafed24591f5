"""The plug-ins of this room, one file each: operation methods that work a field, and guidance line types.

``METHODS`` holds the former by name, ``LINES`` the latter; a new one is one file here and one line in its table.
"""

from collections.abc import Mapping
from types import MappingProxyType

from guidance_app.guidance.line_type import LineType
from guidance_app.guidance.pattern import OperationMethod
from guidance_app.guidance.patterns import (
    a_plus,
    ab_line,
    curve,
    intermediate_division,
    last_pass,
    pivot,
    round_trip,
    surrounding,
    transfer,
)

__all__ = ["LINES", "METHODS"]

METHODS: Mapping[str, OperationMethod] = MappingProxyType(
    {
        method.name: method
        for method in (
            round_trip.METHOD,
            transfer.METHOD,
            intermediate_division.METHOD,
            surrounding.METHOD,
        )
    }
)
"""Ways to work a whole field, by name."""

LINES: Mapping[str, LineType] = MappingProxyType(
    {line.name: line for line in (ab_line.LINE, a_plus.LINE, curve.LINE, pivot.LINE, last_pass.LINE)}
)
"""Ways to drive without a plan, by the name that a stored guidance line has as its type."""
