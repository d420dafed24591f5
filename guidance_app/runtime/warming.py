"""The first minute of a drive taken beforehand, so that every kernel is compiled before the tractor needs it.

numba compiles at the first call and keeps the result on disk; only the first start on a machine takes long. A driver
must not meet that pause in the field, with the receiver running and nothing to steer by.
"""

import itertools
import logging
import threading
from collections.abc import Callable

from guidance_app.engine import Engine
from guidance_app.language import message
from guidance_app.model import SetWork, SetWorkMode, WorkMode
from guidance_app.model.commands import Commanded
from guidance_app.sources.file import load_log
from guidance_app.store import SAMPLE_OPERATION, SAMPLE_RECORDING, Store, StoreError, load_job, sample_folder

__all__ = ["Warming"]

log = logging.getLogger(__name__)

EPOCHS = 400
COMPILING = message("Getting ready. The first time on this machine, and after an update, it takes half a minute.")


class Warming:
    """Takes the beginning of the embedded sample through an engine, on a thread of its own.

    ``say`` is told what goes on, and None when it is over.
    """

    def __init__(self, filter_name: str | None = None, say: Callable[[str | None], None] | None = None) -> None:
        self._filter_name = filter_name
        self._say = say or _say_nothing
        self._thread = threading.Thread(target=self._run, name="warming", daemon=True)

    def start(self) -> None:
        """Begins."""
        self._thread.start()

    def done(self, patience: float | None = None) -> bool:
        """Whether it is over, at the latest after so many seconds; waits for it with None."""
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _run(self) -> None:
        """Whatever goes wrong here, the drive itself compiles what it needs when it needs it."""
        self._say(COMPILING)
        try:
            folder = sample_folder()
            engine = Engine(load_job(Store(folder), SAMPLE_OPERATION), filter_name=self._filter_name)
            chunks = load_log(folder / SAMPLE_RECORDING / "receiver.nmea").chunks
            engine.step(Commanded(0.0, SetWorkMode(WorkMode.BUTTON)))
            engine.step(Commanded(0.0, SetWork(down=True)))
            for chunk in itertools.islice(chunks, EPOCHS):
                engine.step(chunk)
        except StoreError as error:
            log.warning("nothing to warm up with: %s", error)
        except Exception:
            log.exception("warming up failed; the drive compiles what it needs by itself")
        finally:
            self._say(None)


def _say_nothing(_notice: str | None) -> None:
    """Nobody wants to know."""
