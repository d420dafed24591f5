"""Threads, queue and clock around one engine: the live session and the replay under a person's hands."""

from guidance_app.runtime.live import LiveSession
from guidance_app.runtime.replay import ReplayControl, ReplaySession, ReplayState
from guidance_app.runtime.session import Session

__all__ = ["LiveSession", "ReplayControl", "ReplaySession", "ReplayState", "Session"]
