"""Threads, queue and clock around one engine: the live session, recorded, and the replay under a person's hands."""

from guidance_app.runtime.cache import cache_folder
from guidance_app.runtime.corrections import caster_for, caster_of
from guidance_app.runtime.engines import Comparison
from guidance_app.runtime.live import LiveSession
from guidance_app.runtime.manager import SessionManager
from guidance_app.runtime.recorded import recorded_session, resumed_session
from guidance_app.runtime.recorder import Recorder, new_recording
from guidance_app.runtime.replay import ReplayControl, ReplaySession, ReplayState
from guidance_app.runtime.session import Session
from guidance_app.runtime.tap import RawStream, Tap
from guidance_app.runtime.warming import Warming

__all__ = [
    "Comparison",
    "LiveSession",
    "RawStream",
    "Recorder",
    "ReplayControl",
    "ReplaySession",
    "ReplayState",
    "Session",
    "SessionManager",
    "Tap",
    "Warming",
    "cache_folder",
    "caster_for",
    "caster_of",
    "new_recording",
    "recorded_session",
    "resumed_session",
]
