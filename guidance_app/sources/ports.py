"""The serial ports of this machine, with what their makers call them."""

from collections.abc import Callable
from dataclasses import dataclass

from serial.tools import list_ports

__all__ = ["FoundPort", "ListPorts", "found_ports"]


@dataclass(frozen=True, slots=True)
class FoundPort:
    """One port. ``usb`` is VID:PID:serial of the device behind it, ``plug`` where it is plugged in; None for others."""

    path: str
    name: str = ""
    usb: str | None = None
    plug: str | None = None


ListPorts = Callable[[], tuple[FoundPort, ...]]


def found_ports() -> tuple[FoundPort, ...]:
    """The ports that are there now, those of USB devices first."""
    found = [
        FoundPort(
            path=port.device,
            name="" if port.description in (None, "n/a") else port.description,
            usb=None if port.vid is None else f"{port.vid:04X}:{port.pid or 0:04X}:{port.serial_number or ''}",
            plug=port.location,
        )
        for port in list_ports.comports()
    ]
    return tuple(sorted(found, key=lambda port: (port.usb is None, port.path)))
