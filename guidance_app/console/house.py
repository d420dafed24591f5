"""The house around the drive: the documents, what is driven or replayed, files, and long work beside the picture.

One for the whole console. Panels reach it through their hands; nothing here draws.
"""

import logging
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from pydantic import ValidationError

from guidance_app.boundary import BoundaryError
from guidance_app.console.files import Files
from guidance_app.documents import FieldDocument, Job, Method, Operation, Receiver, Settings
from guidance_app.exchange import ExchangeError
from guidance_app.guidance.planning import PlanError
from guidance_app.language import sentence
from guidance_app.model import EndDrive, SessionState, Snapshot
from guidance_app.runtime import (
    LiveSession,
    Session,
    SessionManager,
    caster_for,
    recorded_session,
    resumed_session,
)
from guidance_app.sources import Source, SourceError, open_receiver
from guidance_app.sources.ntrip import Caster, Traffic
from guidance_app.sources.ports import ListPorts, found_ports
from guidance_app.store import Store, StoreError
from guidance_app.store.recordings import job_of_recording
from guidance_app.store.recordings_list import Resumable

__all__ = ["SENTENCES", "House"]

log = logging.getLogger(__name__)

SENTENCES: tuple[type[Exception], ...] = (StoreError, SourceError, ExchangeError, BoundaryError, PlanError)
"""Errors whose message is a sentence for the person at the screen."""
WORKERS = 4
ENDS_S = 1.0
"""So long the engine may take to hear of the end; then the drive is ended without its word."""


class House:
    """What the console can do beside the drive. Its methods may be called from any thread; some take seconds."""

    def __init__(
        self, manager: SessionManager, store: Store | None = None, list_ports: ListPorts = found_ports
    ) -> None:
        self.manager = manager
        self.store = store
        self.list_ports = list_ports
        self.files = Files()
        self.corrections = Traffic()
        """What has come from the caster in this drive."""
        self._workers = ThreadPoolExecutor(WORKERS, thread_name_prefix="house")
        self._changing = threading.Lock()
        self._version = 0
        stored = None if store is None or self.driving else store.settings()
        if stored is not None:
            manager.show_as(stored.document)

    @property
    def driving(self) -> bool:
        """True while a receiver is read or a recording played."""
        return not self.manager.idle

    def settings(self) -> Settings:
        """The driver's settings as they are stored, else those of the drive."""
        stored = None if self.store is None else self.store.settings()
        return self.manager.job.settings if stored is None else stored.document

    # --- what is driven --------------------------------------------------------------------------------------------

    def drive(self, job: Job) -> None:
        """Ends what is driven and drives ``job`` from its receiver's source, recorded. Raises ``SourceError``."""
        source, notices = self._opened(job)
        if self.store is None:
            self.take(LiveSession(job, source, notices=notices))
        else:
            self.take(recorded_session(self.store.root, job, source, notices=notices))

    def use_source(self, uri: str) -> None:
        """Ends what is driven and drives the same job from another receiver. Raises ``SourceError``."""
        job = self.manager.job
        try:
            receiver = Receiver.model_validate({**job.receiver.model_dump(), "source": uri})
        except ValidationError:
            raise SourceError(sentence("The receiver's address is too long: write it shorter.")) from None
        self.drive(job.model_copy(update={"receiver": receiver}))

    def resume(self, found: Resumable, progress: Callable[[float], None] | None = None) -> None:
        """Goes on with a drive that was cut off, from its own receiver. Raises ``StoreError`` or ``SourceError``."""
        source, _ = self._opened(job_of_recording(found.path), found.pass_number)
        self.take(resumed_session(found.path, source, progress))

    def _opened(self, job: Job, number: int | None = None) -> tuple[Source, tuple[str, ...]]:
        """The job's source with the corrections it gets, and what to know of them; ``number`` as ``open_receiver``."""
        caster: Caster | None = None
        notices: tuple[str, ...] = ()
        if self.store is not None:
            try:
                caster = caster_for(self.store.root, job.receiver.source)
            except StoreError as error:
                log.warning("%s", error)
                notices = (sentence("No corrections: {reason}", reason=error.args[0]),)
        self.corrections = Traffic()
        return open_receiver(job, number, caster, self.corrections), notices

    def take(self, session: Session) -> None:
        """Ends what is driven and goes on with this session."""
        with self._changing:
            self.manager.take(session)

    def end(self) -> None:
        """Ends what is driven; the field stays on the screen."""
        with self._changing:
            if not self.manager.idle:
                self._tell_the_end()
                self.manager.rest(_shown_only(self.manager.job, self.manager.job.field))

    def _tell_the_end(self) -> None:
        """The end is a command as any other, so that the recording of a drive holds it."""
        if self.manager.replay is not None:
            return
        ended = threading.Event()

        def hear(snapshot: Snapshot) -> None:
            if snapshot.state is SessionState.ENDED:
                ended.set()

        stop_hearing = self.manager.subscribe(hear)
        self.manager.post(EndDrive())
        ended.wait(ENDS_S)
        stop_hearing()

    def show_field(self, field: FieldDocument | None) -> bool:
        """Shows a field on the map, None for none; False while something is driven, which goes before."""
        with self._changing:
            if not self.manager.idle:
                return False
            self.manager.rest(_shown_only(self.manager.job, field))
            return True

    def show_job(self, job: Job) -> bool:
        """Plans a job and shows it on the map, driving nothing; False while something is driven, which goes before."""
        with self._changing:
            if not self.manager.idle:
                return False
            self.manager.rest(job)
            return True

    # --- long work -------------------------------------------------------------------------------------------------

    @property
    def version(self) -> int:
        """Another number after each work that a person has asked for: what is stored may have changed."""
        return self._version

    def aside(self, work: Callable[[], None]) -> None:
        """Looks at something on another thread; what fails is logged."""

        def run() -> None:
            try:
                work()
            except Exception:
                log.exception("a look at what is stored failed")

        self._workers.submit(run)

    def later(self, work: Callable[[], None], failed: Callable[[str], None]) -> None:
        """Does ``work`` on another thread; ``failed`` hears the sentence when it cannot be done."""

        def run() -> None:
            try:
                work()
                self._version += 1
            except SENTENCES as error:
                failed(str(error))
            except Exception as error:
                log.exception("work asked for at the screen failed")
                failed(
                    sentence(
                        "This failed inside the program ({kind}: {error}). Nothing was changed.",
                        kind=type(error).__name__,
                        error=str(error),
                    )
                )

        self._workers.submit(run)

    def close(self) -> None:
        """Waits for nothing that has not begun."""
        self._workers.shutdown(wait=False, cancel_futures=True)


def _shown_only(job: Job, field: FieldDocument | None) -> Job:
    """The same documents with a field that is only looked at: no plan is made for it."""
    operation = None
    if field is not None:
        operation = Operation(
            name="Look",
            field=field.name,
            tractor=job.tractor.name,
            implement=job.implement.name,
            method=Method.LINE,
        )
    return job.model_copy(update={"field": field, "operation": operation})
