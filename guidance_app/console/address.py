"""Where the console listens, and under which addresses a tablet on the same network finds it. IPv4 only."""

import errno
import ipaddress
import socket
import sys

__all__ = ["ALL_INTERFACES", "LOOPBACK", "ConsoleError", "bind", "is_loopback", "lan_addresses", "own_names"]

LOOPBACK = "127.0.0.1"
ALL_INTERFACES = "0.0.0.0"  # noqa: S104 - only bound when the driver asks for the network, and then behind a PIN


class ConsoleError(Exception):
    """The console cannot start; the message is one sentence that says what is wrong and what to do."""


def bind(host: str, port: int) -> socket.socket:
    """A listening socket; port 0 takes any free one. Raises ``ConsoleError`` when the address cannot be had."""
    if not 0 <= port <= 65535:
        msg = f"Port {port} does not exist; choose one from 1024 to 65535 with --port."
        raise ConsoleError(msg)
    try:
        return socket.create_server((host, port), backlog=128)
    except OSError as error:
        raise ConsoleError(_why_not(host, port, error)) from error


def _why_not(host: str, port: int, error: OSError) -> str:
    match error.errno:
        case errno.EADDRINUSE:
            return f"Port {port} is in use by another program; close it or choose another port with --port."
        case errno.EACCES:
            return f"Port {port} needs rights that this user has not; choose one above 1023 with --port."
        case errno.EADDRNOTAVAIL:
            return f"{host} is not an address of this machine; leave it out or choose one that is."
        case _:
            return f"{host}:{port} cannot be opened ({error.strerror or error}); choose another port with --port."


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach ``host``."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def own_names() -> frozenset[str]:
    """The names under which this machine may be addressed, in lower case, beside its numeric addresses."""
    name = socket.gethostname().lower()
    short = name.partition(".")[0]
    return frozenset({"localhost", name, short, f"{short}.local", f"{short}.lan", f"{short}.home"})


def lan_addresses() -> tuple[str, ...]:
    """This machine's addresses on its networks, the one with the way out first. Empty without a network."""
    found = [*_towards_outside(), *_of_interfaces(), *_of_name()]
    return tuple(dict.fromkeys(address for address in found if not ipaddress.ip_address(address).is_loopback))


def _towards_outside() -> list[str]:
    """The address packets to elsewhere would carry. Connecting a datagram socket sends nothing."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
        except OSError:
            return []
        return [str(probe.getsockname()[0])]


def _of_interfaces() -> list[str]:
    """Every interface's address: a tablet's own network has no way out, and is still the one that matters."""
    if sys.platform != "linux":
        return []
    import fcntl  # noqa: PLC0415 - exists on Linux only
    import struct  # noqa: PLC0415

    addresses = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            try:
                answer = fcntl.ioctl(probe.fileno(), 0x8915, struct.pack("256s", name.encode()[:15]))
            except OSError:
                continue  # an interface without an address
            addresses.append(socket.inet_ntoa(answer[20:24]))
    return addresses


def _of_name() -> list[str]:
    try:
        return list(socket.gethostbyname_ex(socket.gethostname())[2])
    except OSError:
        return []
