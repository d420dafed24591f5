"""The baud rate's search as pure steps, and its memory."""

from pathlib import Path

import pytest
from support.nmea import epoch, sentence

from guidance_app.sources.baud import BAUD_RATES, LONGER_TRY_S, LOST_S, TRY_S, BaudHunt, BaudMemory

NOON = 43200.0
NOISE = bytes(range(128, 256))


def test_it_tries_each_rate_for_its_time_and_begins_anew() -> None:
    hunt = BaudHunt()
    tried = [hunt.rate]
    now = 0.0
    while len(tried) <= len(BAUD_RATES):
        now += 0.1
        if hunt.hear(NOISE, now):
            tried.append(hunt.rate)
    assert tuple(tried) == (*BAUD_RATES, BAUD_RATES[0])
    assert now == pytest.approx(len(BAUD_RATES) * (TRY_S + 0.2), abs=1.0)


def test_silence_says_nothing_about_the_rate() -> None:
    hunt = BaudHunt()
    assert not any(hunt.hear(b"", float(second)) for second in range(100))
    assert not hunt.hear(NOISE, 100.0)
    assert hunt.rate == BAUD_RATES[0]


def test_two_whole_sentences_take_the_rate_and_the_remembered_one_comes_first() -> None:
    hunt = BaudHunt(38400)
    assert hunt.rate == 38400
    assert not hunt.hear(sentence("PUBX,00,something of the maker"), 0.0)
    assert hunt.hear(sentence("GPHDT,12.0,T"), 0.5)
    assert hunt.found
    assert hunt.rate == 38400


def test_a_slow_receiver_gets_more_time_once_a_sentence_was_whole() -> None:
    hunt = BaudHunt()
    assert not hunt.hear(sentence("GPHDT,12.0,T"), 0.0)
    assert not hunt.hear(NOISE, TRY_S + 0.2)
    assert hunt.hear(sentence("GPHDT,12.0,T"), LONGER_TRY_S - 0.1)
    assert hunt.found


def test_sentences_without_a_checksum_are_no_proof() -> None:
    hunt = BaudHunt()
    for step in range(10):
        hunt.hear(b"$GPHDT,12.0,T\r\n", step * 0.1)
    assert not hunt.found


def test_when_the_receiver_is_set_anew_the_search_begins_again() -> None:
    hunt = BaudHunt()
    hunt.hear(epoch(NOON), 0.0)
    assert hunt.found
    assert not hunt.hear(NOISE, 1.0)
    assert not hunt.hear(epoch(NOON + 1), 2.0)
    assert not hunt.hear(NOISE, 3.0)
    assert hunt.hear(NOISE, 3.0 + LOST_S + 0.1)
    assert not hunt.found
    assert hunt.rate == BAUD_RATES[1]


def test_rates_are_remembered_by_device(tmp_path: Path) -> None:
    memory = BaudMemory(tmp_path / "deep" / "rates.json")
    assert memory.recall("0403:6001:A9") is None
    memory.keep("0403:6001:A9", 38400)
    memory.keep("/dev/ttyS0", 4800)
    memory.keep("/dev/ttyS0", 4800)
    again = BaudMemory(tmp_path / "deep" / "rates.json")
    assert (again.recall("0403:6001:A9"), again.recall("/dev/ttyS0")) == (38400, 4800)
    assert [one.name for one in (tmp_path / "deep").iterdir()] == ["rates.json"]


@pytest.mark.parametrize("damaged", ["", "[1, 2]", '{"a": "fast"}', '{"a": 12345}', "{" + " " * 70_000 + "}"])
def test_a_damaged_memory_is_no_memory(tmp_path: Path, damaged: str) -> None:
    path = tmp_path / "rates.json"
    path.write_text(damaged)
    assert BaudMemory(path).recall("a") is None
    BaudMemory(path).keep("a", 9600)
    assert BaudMemory(path).recall("a") == 9600


def test_a_memory_that_cannot_be_written_costs_only_time(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    memory = BaudMemory(blocked / "rates.json")
    memory.keep("a", 9600)
    assert memory.recall("a") is None


def test_it_has_a_place_of_its_own() -> None:
    assert BaudMemory().path.name == "baud-rates.json"
