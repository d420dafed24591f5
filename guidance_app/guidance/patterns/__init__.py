"""The plug-ins of this room, one file each: operation methods that work a field, and guidance line types.

``PATTERNS`` holds both by name; a new pattern is one file here and one line in its table.
"""

from collections.abc import Mapping
from types import MappingProxyType

from guidance_app.guidance.pattern import OperationMethod
from guidance_app.guidance.patterns import intermediate_division, round_trip, surrounding, transfer

__all__ = ["METHODS"]

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
