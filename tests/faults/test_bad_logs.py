"""Files that are no good logs: one sentence that says what is wrong and what to do, or the log all the same."""

import gzip
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.nmea import epoch, fixes_of, gga, hdt, observations_of, sentence

from guidance_app.cli import main
from guidance_app.sources import SourceError, open_source
from guidance_app.sources.file import load_log

NOON = 43200.0
GOOD = b"".join(epoch(NOON + k, float(k)) for k in range(10))


def _file(folder: Path, data: bytes, name: str = "run.nmea") -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


BAD = {
    "empty": b"",
    "blank": b"\r\n\r\n",
    "prose": b"Dear reader, this is a letter.\n" * 50,
    "json": b'{"type": "FeatureCollection", "features": []}',
    "picture": b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 200,
    "zeros": b"\x00" * 5000,
    "damaged": b"".join(line[:20] + b"~" + line[20:] for line in GOOD.splitlines(keepends=True)),
    "damaged archive": gzip.compress(GOOD)[:-20],
    "empty archive": gzip.compress(b""),
    "archive of something else": gzip.compress(b"hello" * 100),
    "shell": b"#!/bin/sh\necho $PATH, $HOME\nexport $USER\n",
    "one mark": b"$",
    "utf-16 prose": "Guten Tag".encode("utf-16"),
}


@pytest.mark.parametrize("kind", BAD)
def test_a_file_that_is_no_log_is_refused_in_one_sentence(tmp_path: Path, kind: str) -> None:
    path = _file(tmp_path, BAD[kind])
    with pytest.raises(SourceError) as caught:
        load_log(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert "\n" not in text
    assert text.endswith(".")
    assert ": " in text or ";" in text, "what to do is missing"


@pytest.mark.parametrize("kind", BAD)
def test_the_command_says_it_and_ends_with_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    table = tmp_path / "fixes.csv"
    assert main(["inspect", str(_file(tmp_path, BAD[kind])), "--fixes", str(table)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert "Traceback" not in said.err
    assert sorted(one.name for one in tmp_path.iterdir()) == ["run.nmea"]


PARTS = [
    GOOD[:200],
    b"$GPGGA,",
    b"$KSXT,2020",
    b"\xff\xfe",
    b"\x1f\x8b",
    b"$",
    b"\n",
    b"2020-01-02T12:00:00 $",
    b"\x00" * 9,
]


@given(st.lists(st.sampled_from(PARTS) | st.binary(max_size=40), max_size=12).map(b"".join))
def test_any_bytes_are_a_log_or_are_refused(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    path = _file(tmp_path_factory.getbasetemp(), data)
    try:
        log = load_log(path)
    except SourceError as error:
        said = str(error)
    else:
        said = f"{log.has_fix}, {log.duration}"
        assert len(log.chunks) > 0
    assert said


def test_a_missing_file_a_folder_and_a_pipe_are_named(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for place, word in (("missing.nmea", "no file"), (".", "folder"), ("pipe", "not an ordinary file")):
        with pytest.raises(SourceError, match=word):
            load_log(tmp_path / place)


def test_a_path_that_cannot_be_is_named() -> None:
    with pytest.raises(SourceError):
        load_log(Path("run\x00.nmea"))


def test_a_file_that_may_not_be_read_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(path: Path) -> bytes:
        raise PermissionError(13, "Permission denied", str(path))

    path = _file(tmp_path, GOOD)
    monkeypatch.setattr(Path, "read_bytes", forbidden)
    with pytest.raises(SourceError, match="may not be read"):
        load_log(path)


@pytest.mark.parametrize("uri", ["run.nmea", "ftp:run.nmea", "", "file:", "file:/no/such/log.nmea"])
def test_a_uri_that_names_nothing_is_refused_with_what_would_do(uri: str) -> None:
    with pytest.raises(SourceError, match=r"file:|There is no file"):
        open_source(uri)


def test_a_table_that_cannot_be_written_leaves_nothing_behind(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = _file(tmp_path, GOOD)
    place = tmp_path / "run.nmea" / "fixes.csv"
    assert main(["inspect", str(log), "--fixes", str(place)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert [one.name for one in tmp_path.iterdir()] == ["run.nmea"]


@pytest.mark.parametrize(
    "data",
    [
        GOOD.replace(b"\r\n", b"\n"),
        GOOD.replace(b"\r\n", b"\r"),
        GOOD.decode().encode("utf-16"),
        GOOD.decode().encode("utf-16-le"),
        GOOD.decode().encode("utf-16-be"),
        b"\xef\xbb\xbf" + GOOD,
        gzip.compress(GOOD),
        b"# a comment $GPGGA,1*00\r\n" + GOOD,
        b"\xb5b\x01\x07\x5c\x00$\r".join(GOOD.splitlines(keepends=True)),
        GOOD.replace(b"$", b"2020-01-02T12:00:00.5Z $"),
        GOOD[:-2],
        b"\r\n".join(line.partition(b"*")[0] for line in GOOD.splitlines()),
    ],
    ids=["lf", "cr", "utf-16", "le", "be", "bom", "gzip", "comment", "binary", "prefix", "no end", "bare"],
)
def test_a_log_in_another_dress_gives_the_same_fixes(tmp_path: Path, data: bytes) -> None:
    plain = fixes_of(observations_of(load_log(_file(tmp_path, GOOD)).chunks))
    dressed = load_log(_file(tmp_path, data, "dressed.log"))
    assert fixes_of(observations_of(dressed.chunks)) == plain
    assert dressed.duration == 9.0
    assert dressed.has_fix


def test_a_log_whose_line_ends_are_lost_still_gives_every_position(tmp_path: Path) -> None:
    """A sentence then ends where the next begins, so the last of an epoch comes too late for its fix."""
    plain = fixes_of(observations_of(load_log(_file(tmp_path, GOOD)).chunks))
    glued = fixes_of(observations_of(load_log(_file(tmp_path, GOOD.replace(b"\r\n", b""))).chunks))
    assert [(one.t, one.arrival, one.latitude_deg, one.longitude_deg) for one in glued] == [
        (one.t, one.arrival, one.latitude_deg, one.longitude_deg) for one in plain
    ]


@pytest.mark.parametrize(
    "data",
    [
        b"".join(gga(NOON + k, quality="0") for k in range(5)),
        b"".join(hdt(float(k)) for k in range(5)),
        b"".join(sentence(f"GPZDA,12000{k}.00,02,01,2020,00,00") for k in range(5)),
        sentence("GPTXT,01,01,02,u-blox ag - www.u-blox.com"),
    ],
    ids=["no fix yet", "compass", "clock", "greeting"],
)
def test_a_log_without_a_fix_loads_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str], data: bytes) -> None:
    path = _file(tmp_path, data)
    assert not load_log(path).has_fix
    assert main(["inspect", str(path)]) == 0
    assert "no fix" in capsys.readouterr().out


def test_a_log_that_breaks_off_in_a_sentence_keeps_what_is_whole(tmp_path: Path) -> None:
    path = _file(tmp_path, GOOD[: len(GOOD) - 100])
    assert len(fixes_of(observations_of(load_log(path).chunks))) == 9
