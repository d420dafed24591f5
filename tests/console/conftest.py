"""The fixtures of the browser and of the console, for all tests of the console."""

from support.chromium import chromium, open_page, open_shared_page
from support.consoles import start_console

__all__ = ["chromium", "open_page", "open_shared_page", "start_console"]
