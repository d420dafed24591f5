"""The session manager: one session that the whole console sees, whatever it drives at the moment.

The console is opened once and stays open while the driver looks at fields, drives, ends and replays. The manager is
itself a session: it hands every call to the one in use and carries those who hear over to the next. ``episode``
changes with each one, so that a screen knows that it has to be made anew.
"""

import logging
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from guidance_app.documents import Implement, Job, Receiver, Settings, Tractor
from guidance_app.model import Command, SessionState, Snapshot
from guidance_app.runtime.live import LiveSession
from guidance_app.runtime.session import Hearer, Session
from guidance_app.runtime.tap import Tap

if TYPE_CHECKING:
    from guidance_app.runtime.replay import ReplayControl

__all__ = ["SessionManager", "idle_job", "idle_session"]

log = logging.getLogger(__name__)


def idle_job(job: Job | None = None) -> Job:
    """The documents of a console that does not drive: those of ``job``, else plain ones without a field."""
    if job is not None:
        return job
    return Job(
        tractor=Tractor(name="Tractor"), implement=Implement(name="Implement"), receiver=Receiver(name="Receiver")
    )


def idle_session(job: Job | None = None) -> LiveSession:
    """A session without a receiver, that shows the field of its job if there is one."""
    return LiveSession(idle_job(job), None)


def _shown_as(job: Job, settings: Settings | None) -> Job:
    """The job with other settings for the screen. The guided point belongs to the engine, which cannot change it."""
    if settings is None:
        return job
    shown = settings.model_copy(update={"guide_implement": job.settings.guide_implement})
    return job.model_copy(update={"settings": shown})


class SessionManager:
    """Hands everything to the session in use. Every method may be called from any thread."""

    def __init__(self, first: Session | None = None) -> None:
        self._idle = first is None
        self._session: Session = idle_session() if first is None else first
        self._episode = 0
        self._settings: Settings | None = None
        self._notice: str | None = None
        self._shown: tuple[Session, Settings | None, Job] | None = None
        self._hearers: dict[int, Hearer] = {}
        self._stop_hearing: dict[int, Callable[[], None]] = {}
        self._next = 0
        self._lock = threading.RLock()
        self._started = False
        self._closed = False

    @property
    def session(self) -> Session:
        """The session in use."""
        return self._session

    @property
    def episode(self) -> int:
        """Another number for each session that comes into use."""
        return self._episode

    @property
    def idle(self) -> bool:
        """True while nothing is driven and nothing is replayed."""
        return self._idle

    @property
    def job(self) -> Job:
        """The documents in use, with the settings that are shown."""
        session, settings, shown = self._session, self._settings, self._shown
        if shown is None or shown[0] is not session or shown[1] is not settings:
            shown = (session, settings, _shown_as(session.job, settings))
            self._shown = shown
        return shown[2]

    def show_as(self, settings: Settings) -> None:
        """From now on the screen follows these settings; which point is guided stays as the session began."""
        self._settings = settings

    @property
    def tap(self) -> Tap:
        """The newest bytes of the receiver in use."""
        return self._session.tap

    @property
    def replay(self) -> "ReplayControl | None":
        """Play, pause and seek; None when the source is live."""
        return self._session.replay

    def say(self, notice: str | None) -> None:
        """From now on this stands before the notices of every session; None takes it back."""
        self._notice = notice

    def snapshot(self) -> Snapshot:
        """The newest snapshot."""
        snapshot, notice = self._session.snapshot(), self._notice
        return snapshot if notice is None else replace(snapshot, notices=(notice, *snapshot.notices))

    def now(self) -> float:
        """The clock of the session in use."""
        return self._session.now()

    def post(self, command: Command) -> None:
        """Hands a command to the engine in use; never waits."""
        self._session.post(command)

    def subscribe(self, hear: Hearer) -> Callable[[], None]:
        """Calls ``hear`` after each new snapshot, of whichever session is in use then."""
        with self._lock:
            key = self._next
            self._next += 1
            self._hearers[key] = hear
            self._stop_hearing[key] = self._session.subscribe(hear)

        def unsubscribe() -> None:
            with self._lock:
                self._hearers.pop(key, None)
                stop = self._stop_hearing.pop(key, None)
            if stop is not None:
                stop()

        return unsubscribe

    def start(self) -> None:
        """Begins to run the session in use."""
        with self._lock:
            self._started = True
            self._session.start()

    def take(self, session: Session) -> None:
        """Ends the session in use and goes on with this one, which must not have been started."""
        self._change(session, idle=False)

    def rest(self, job: Job | None = None) -> None:
        """Ends the session in use; then nothing is driven, and the field of ``job`` is shown if it has one."""
        self._change(idle_session(job), idle=True)

    def _change(self, session: Session, *, idle: bool) -> None:
        with self._lock:
            if self._closed:
                session.close()
                return
            before = self._session
            for stop in self._stop_hearing.values():
                stop()
            before.close()  # before the next one starts, which may read from the same port
            self._session, self._idle = session, idle
            self._stop_hearing = {key: session.subscribe(hear) for key, hear in self._hearers.items()}
            self._episode += 1
            if self._started:
                session.start()
            hearers = tuple(self._hearers.values())
        for hear in hearers:
            try:
                hear(session.snapshot())
            except Exception:
                log.exception("a hearer failed at the change of sessions")

    def close(self) -> None:
        """Ends the session in use; none follows. A drive that nobody ended can be gone on with at the next start.

        So a machine that is shut down with the ignition key loses no drive, however it is told to stop.
        """
        with self._lock:
            self._closed = True
            session = self._session
        if isinstance(session, LiveSession):
            session.close(ended=session.snapshot().state is SessionState.ENDED)
        else:
            session.close()
