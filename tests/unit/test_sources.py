import importlib
import threading
from pathlib import Path

import pytest
from support.nmea import epoch

from guidance_app.model import Chunk, SourceUp
from guidance_app.sources import SOURCES, SourceError, open_source

NOON = 43200.0


@pytest.mark.parametrize("scheme", SOURCES)
def test_every_scheme_names_an_opener_that_refuses_nonsense(scheme: str) -> None:
    module, _, name = SOURCES[scheme].partition(":")
    opener = getattr(importlib.import_module(module), name)
    with pytest.raises(SourceError):
        opener(f"{scheme}:no/such/place?at=all")


def test_what_is_opened_keeps_its_own_time(tmp_path: Path) -> None:
    path = tmp_path / "run.nmea"
    path.write_bytes(epoch(NOON) + epoch(NOON + 30))
    source = open_source(f"file:{path}")
    assert source.live
    assert (source.description, source.duration) == ("run.nmea", 30.0)
    stop = threading.Event()
    events = source.events(stop)
    assert isinstance(next(events), SourceUp)
    assert next(events) == Chunk(0.0, epoch(NOON))
    stop.set()
    assert list(events) == []


def test_a_scheme_may_be_written_in_capitals(tmp_path: Path) -> None:
    path = tmp_path / "run.nmea"
    path.write_bytes(epoch(NOON))
    assert open_source(f"FILE:{path}").duration == 0.0


@pytest.mark.parametrize("uri", ["", "run.nmea", "/dev/ttyUSB0", "ftp://host/run", "nothing:"])
def test_an_unknown_scheme_is_answered_with_those_that_are_known(uri: str) -> None:
    with pytest.raises(SourceError, match=r"serial:, tcp:, udp:, gpsd:, file:, sim:"):
        open_source(uri)
