"""The fixtures of the browser and of the console, and the watch on who draws, for all tests of the console."""

from support.chromium import chromium, open_page, open_shared_page
from support.consoles import start_console
from support.drawing_threads import one_thread_draws
from support.stage import server

__all__ = ["chromium", "one_thread_draws", "open_page", "open_shared_page", "server", "start_console"]
