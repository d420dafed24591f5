"""The fixtures of the browser, for all tests of the console."""

from support.chromium import chromium, open_page

__all__ = ["chromium", "open_page"]
