"""The account at a caster: kept for its owner alone, told to nobody, used by the drive whose receiver can take it."""

import io
import stat
import zipfile
from pathlib import Path

import pytest
from pydantic import ValidationError
from support.caster import FRAMES, MOUNT, PASSWORD, USER, local_caster
from support.drives import a_job
from support.recordings import Heard
from support.servers import server

from guidance_app.commands import run as run_command
from guidance_app.console.house import House
from guidance_app.documents.caster import CasterAccount
from guidance_app.language import words_for
from guidance_app.model import CORRECTIONS, LinkState, LinkStatus
from guidance_app.runtime import SessionManager, caster_for, caster_of
from guidance_app.sources import SourceError, open_receiver, takes_corrections
from guidance_app.sources.kept import LinkError
from guidance_app.sources.ntrip import Traffic, first_corrections, mount_points
from guidance_app.store import Store, StoreError
from guidance_app.store.backup import restore, write_backup
from guidance_app.store.caster import ACCOUNT, caster_account, forget_caster_account, keep_caster_account
from guidance_app.view.receiver import caster_words

SOON_S = 0.3
SERIAL = "serial:///dev/ttyUSB0"


def an_account(port: int = 2101, **changes: object) -> CasterAccount:
    members = {"host": "127.0.0.1", "port": port, "mount": MOUNT, "user": USER, "password": PASSWORD, **changes}
    return CasterAccount.model_validate(members)


def test_it_comes_back_and_its_owner_alone_can_read_it(tmp_path: Path) -> None:
    assert caster_account(tmp_path) is None
    (tmp_path / f".{ACCOUNT}.tmp").touch(0o644)  # as a power cut may leave it
    keep_caster_account(tmp_path, an_account())
    assert caster_account(tmp_path) == an_account()
    assert stat.S_IMODE((tmp_path / ACCOUNT).stat().st_mode) == 0o600
    keep_caster_account(tmp_path, an_account(on=False))
    assert caster_account(tmp_path) == an_account(on=False)
    assert stat.S_IMODE((tmp_path / ACCOUNT).stat().st_mode) == 0o600
    forget_caster_account(tmp_path)
    forget_caster_account(tmp_path)
    assert caster_account(tmp_path) is None


def test_no_backup_holds_it_and_a_restore_leaves_it(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.save(a_job().tractor)
    keep_caster_account(tmp_path, an_account())
    packed = io.BytesIO()
    write_backup(tmp_path, packed)
    with zipfile.ZipFile(packed) as archive:
        contents = b"".join(archive.read(name) for name in archive.namelist())
    assert PASSWORD.encode() not in contents
    assert USER.encode() not in contents
    restore(tmp_path, packed)
    assert caster_account(tmp_path) == an_account()


def test_no_text_and_no_error_shows_the_password(tmp_path: Path) -> None:
    account = an_account()
    assert PASSWORD not in f"{account!r} {account} {caster_of(account)!r}"
    with pytest.raises(ValidationError) as wrong:
        an_account(port=0, user="a:b")
    assert PASSWORD not in str(wrong.value)
    (tmp_path / ACCOUNT).write_text(an_account().model_dump_json()[:-1], encoding="utf-8")
    with pytest.raises(StoreError, match="is damaged: enter it again") as damaged:
        caster_account(tmp_path)
    assert PASSWORD not in str(damaged.value)
    (tmp_path / ACCOUNT).unlink()
    (tmp_path / ACCOUNT).mkdir()
    with pytest.raises(StoreError, match="cannot be read"):
        caster_account(tmp_path)
    with pytest.raises(StoreError, match="stays"):
        forget_caster_account(tmp_path)


@pytest.mark.parametrize(
    ("member", "value"),
    [
        ("host", ""),
        ("host", "ntrip://caster.example.org"),
        ("host", "me@caster.example.org"),
        ("host", "caster.example.org\r\nX: y"),
        ("mount", "/"),
        ("mount", "A/B"),
        ("mount", "A\x07"),
        ("user", "a:b"),
        ("user", "a\r\nb"),
        ("port", 65536),
    ],
)
def test_what_no_caster_has_is_refused(member: str, value: object) -> None:
    with pytest.raises(ValidationError) as wrong:
        an_account(**{member: value})
    assert [one["loc"] for one in wrong.value.errors()] == [(member,)]


def test_a_mount_point_may_be_written_with_its_slash() -> None:
    assert an_account(mount=f" /{MOUNT} ").mount == MOUNT


def test_a_drive_takes_it_where_its_receiver_can(tmp_path: Path) -> None:
    assert caster_for(tmp_path, SERIAL) is None
    keep_caster_account(tmp_path, an_account())
    for uri in (SERIAL, "tcp://localhost:9000"):
        assert takes_corrections(uri)
        assert caster_for(tmp_path, uri) == caster_of(an_account())
    for uri in ("sim:", "udp://:9999", "file:log.nmea"):
        assert caster_for(tmp_path, uri) is None
    keep_caster_account(tmp_path, an_account(on=False))
    assert caster_for(tmp_path, SERIAL) is None


def is_corrected(link: LinkState | None) -> bool:
    return link is not None and link.status is LinkStatus.CORRECTED


def job_at(uri: str):
    job = a_job()
    return job.model_copy(update={"receiver": job.receiver.model_copy(update={"source": uri})})


def test_what_is_recorded_and_described_holds_neither_user_nor_password(tmp_path: Path) -> None:
    with local_caster(2) as caster, server(lambda *_: None) as receiver:
        keep_caster_account(tmp_path, an_account(caster.server.port))
        house = House(SessionManager(), Store(tmp_path))
        try:
            house.drive(job_at(f"tcp://127.0.0.1:{receiver.port}"))
            heard = Heard(house.manager)
            house.manager.start()
            heard.wait(lambda one: is_corrected(one.links_beside.get(CORRECTIONS)))
            (folder,) = (tmp_path / "recordings").iterdir()
            session = (folder / "session.json").read_text(encoding="utf-8")
        finally:
            house.manager.close()
            house.close()
    assert MOUNT in session
    for secret in (USER, PASSWORD):
        assert secret not in session
        assert all(secret.encode() not in path.read_bytes() for path in folder.iterdir() if path.is_file())


def test_a_damaged_account_stops_no_drive_and_the_driver_is_told(tmp_path: Path) -> None:
    (tmp_path / ACCOUNT).write_text("{", encoding="utf-8")
    house = House(SessionManager(), Store(tmp_path))
    house.drive(job_at("tcp://127.0.0.1:9"))
    assert any("is damaged: enter it again" in one for one in house.manager.snapshot().notices)
    house.manager.close()
    house.close()


def test_a_receiver_that_takes_none_is_refused_where_a_caster_was_named() -> None:
    with pytest.raises(SourceError, match="takes no corrections"):
        open_receiver(job_at("udp://:0"), caster=caster_of(an_account()), traffic=Traffic())


@pytest.mark.parametrize("version", [1, 2])
def test_a_try_says_what_came_or_why_nothing_did(version: int) -> None:
    with local_caster(version) as caster:
        port = caster.server.port
        assert 0 < first_corrections(caster_of(an_account(port))) <= sum(map(len, FRAMES))
        with pytest.raises(LinkError, match="refuses user and password"):
            first_corrections(caster_of(an_account(port, password="wrong")))
        with pytest.raises(LinkError, match="has no mount point ELSEWHERE"):
            first_corrections(caster_of(an_account(port, mount="ELSEWHERE")))
    with pytest.raises(LinkError, match="nothing answers at its port"):
        first_corrections(caster_of(an_account(port)))


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("cut", [7, 1000])
def test_a_caster_tells_its_mount_points(version: int, cut: int) -> None:
    with local_caster(version, cut=cut) as caster:
        assert mount_points(caster_of(an_account(caster.server.port))) == ("FAR", MOUNT)
        with pytest.raises(LinkError, match="refuses user and password"):
            mount_points(caster_of(an_account(caster.server.port, password="wrong")))


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (b"SOURCETABLE 200 OK\r\n\r\nENDSOURCETABLE\r\n", "names no mount points: write the one"),
        (b"HTTP/1.1 503 Full\r\n\r\n", "refuses: HTTP/1.1 503 Full"),
        (b"", "has closed the connection"),
    ],
)
def test_a_caster_without_a_table_is_said(answer: bytes, words: str) -> None:
    with (
        server(lambda connection, _: (connection.recv(4096), connection.sendall(answer))) as other,
        pytest.raises(LinkError, match=words),
    ):
        mount_points(caster_of(an_account(other.port)))


def test_a_caster_that_waits_for_a_position_has_sent_nothing() -> None:
    def silent(connection, _number: int) -> None:
        connection.recv(4096)
        connection.sendall(b"ICY 200 OK\r\n\r\n")
        connection.recv(1)

    with server(silent) as quiet:
        assert first_corrections(caster_of(an_account(quiet.port)), SOON_S) == 0


def test_the_command_line_takes_the_account_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given: list[object] = []

    class OpenedError(Exception):
        pass

    def opened(_uri: str, _attitude: str | None, caster: object) -> None:
        given.append(caster)
        raise OpenedError

    import argparse  # noqa: PLC0415 - this test's alone

    keep_caster_account(tmp_path, an_account())
    monkeypatch.setattr(run_command, "open_source", opened)
    parser = argparse.ArgumentParser()
    run_command.add_parser(parser.add_subparsers())
    for more in ([], ["--ntrip", "ntrip://other.example.org/M"]):
        with pytest.raises(OpenedError):
            run_command.run(parser.parse_args(["run", "--source", SERIAL, "--data", str(tmp_path), *more]))
    (tmp_path / ACCOUNT).write_text("{", encoding="utf-8")
    with pytest.raises(OpenedError):
        run_command.run(parser.parse_args(["run", "--source", SERIAL, "--data", str(tmp_path)]))
    assert given[0] == caster_of(an_account())
    assert given[1] not in (None, given[0])
    assert given[2] is None
    assert "driving without corrections: " in capsys.readouterr().out


def test_the_screen_says_what_comes_from_it() -> None:
    words = words_for("en")
    up = LinkState(LinkStatus.CORRECTED, what="NEAREST of 127.0.0.1")
    assert caster_words(up, 0, None, words)[1] == "fair"
    assert caster_words(up, 12_340, 0.4, words) == (
        "NEAREST of 127.0.0.1: 12.3 kB received, the newest <1 s ago.",
        "good",
    )
    assert caster_words(up, 12_340, 40.0, words)[1] == "fair"
    down = LinkState(LinkStatus.DOWN, reason="it is off")
    assert caster_words(down, 5, 1.0, words) == ("No corrections: it is off", "bad")
    assert caster_words(LinkState(LinkStatus.CONNECTING), 0, None, words)[1] == "fair"
