"""A watch on viser's own queue: which thread makes, changes and removes what the page shows.

One thread draws. It makes, changes and removes widgets and nodes of the scene; a callback on viser's loop may change a
widget of the page that it belongs to, and nothing else. Any other thread could meet a widget that the redraw has just
taken away, and fail in the middle of its work. Notifications are free.
"""

import asyncio
import threading
import traceback
from collections.abc import Iterator

import pytest
from viser.infra._async_message_buffer import AsyncMessageBuffer
from viser.infra._messages import Message

__all__ = ["DRAWING_THREADS", "one_thread_draws"]

DRAWING_THREADS = frozenset({"screen", "MainThread"})
"""The console's own redraw, and the test that calls ``Screen.tick`` itself."""
DRAWN = frozenset({"gui", "scene", "modal"})
UNTYPED = frozenset({"ResetGuiMessage", "SetGuiPanelLabelMessage", "ScenePointerEnableMessage"})
"""Messages about what is drawn to which viser gives no type of what they are about."""
OURS = "guidance_app"


def _is_drawing(message: Message) -> bool:
    return message.entity_type in DRAWN or type(message).__name__ in UNTYPED


def _may(message: Message, buffer: AsyncMessageBuffer) -> bool:
    """Whether this thread may queue this message."""
    if threading.current_thread().name in DRAWING_THREADS:
        return True
    try:
        on_visers_loop = asyncio.get_running_loop() is buffer.event_loop
    except RuntimeError:
        on_visers_loop = False
    changes_a_widget = message.entity_type == "gui" and message.lifecycle_phase == "update_dict"
    return on_visers_loop and changes_a_widget


@pytest.fixture(autouse=True)
def one_thread_draws(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Fails a test in which another thread has drawn, with the line of ours that did."""
    push = AsyncMessageBuffer.push
    found: list[str] = []

    def watched(buffer: AsyncMessageBuffer, message: Message) -> None:
        if _is_drawing(message) and not _may(message, buffer):
            frames = [one for one in traceback.extract_stack() if OURS in one.filename]
            where = f"{frames[-1].filename}:{frames[-1].lineno}" if frames else "viser itself"
            found.append(f"{type(message).__name__} by thread {threading.current_thread().name} at {where}")
        push(buffer, message)

    monkeypatch.setattr(AsyncMessageBuffer, "push", watched)
    yield
    if found:
        pytest.fail("drawn by another thread than the redraw:\n" + "\n".join(dict.fromkeys(found)))
