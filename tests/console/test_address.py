"""Under which addresses the console listens and is found."""

import ipaddress
import socket

import pytest

from guidance_app.console.address import bind, is_loopback, lan_addresses, own_names


@pytest.mark.parametrize("host", ["127.0.0.1", "127.1.2.3", "::1", "localhost"])
def test_loopback_is_this_machine_alone(host: str) -> None:
    assert is_loopback(host)


@pytest.mark.parametrize("host", ["0.0.0.0", "192.0.2.7", "::", "example.org", ""])
def test_everything_else_is_not(host: str) -> None:
    assert not is_loopback(host)


def test_a_bound_port_takes_connections_at_once() -> None:
    with bind("127.0.0.1", 0) as listener, socket.create_connection(listener.getsockname(), timeout=5) as there:
        here, _ = listener.accept()
        here.close()
        assert there.recv(1) == b""


def test_lan_addresses_are_this_machines_and_not_loopback() -> None:
    for address in lan_addresses():
        assert not ipaddress.ip_address(address).is_loopback
        bind(address, 0).close()


def test_the_machine_may_be_called_by_its_name() -> None:
    assert {"localhost", socket.gethostname().lower()} <= own_names()
