"""What is compiled before a drive begins."""

import pytest

from guidance_app.estimation.filters import FILTERS
from guidance_app.runtime import Warming


def test_every_filter_is_warmed_up_without_a_complaint(caplog: pytest.LogCaptureFixture) -> None:
    for name in FILTERS:
        said: list[str | None] = []
        warming = Warming(name, said.append)
        warming.start()
        assert warming.done()
        assert said[0]
        assert said[1:] == [None]
    assert caplog.records == []
