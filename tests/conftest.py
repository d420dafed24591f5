"""What all tests share: where the real logs are, and what a skip means on the machine that must not skip."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("unhurried", deadline=None)  # the first call of a kernel compiles it
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable" if os.environ.get("GUIDANCE_ALL_TESTS") else "unhurried")
"""The one check of all says the same twice of the same commit; a run by hand looks at new examples each time."""

ROOT = Path(__file__).parent.parent
REAL_DATA = ROOT.parent / "shared" / "data"


def missing(what: str) -> None:
    """Skips for a missing part, or fails where ``GUIDANCE_ALL_TESTS`` says that every part must be there."""
    if os.environ.get("GUIDANCE_ALL_TESTS"):
        pytest.fail(f"{what}, and GUIDANCE_ALL_TESTS forbids skipping")
    pytest.skip(what)


@pytest.fixture(scope="session")
def real_data() -> Path:
    """The folder of real receiver logs and field polygons that lies beside the checkout."""
    if not REAL_DATA.is_dir():
        missing(f"the real logs are not beside the project ({REAL_DATA})")
    return REAL_DATA


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What tests keep is not kept in the user's cache."""
    os.environ["GUIDANCE_CACHE"] = str(tmp_path_factory.mktemp("cache"))
    yield
    del os.environ["GUIDANCE_CACHE"]
