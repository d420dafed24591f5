"""Who has the wheel: exactly one who is there, or nobody; asking, giving, keeping, silence, and going away."""

import itertools

from hypothesis import given
from hypothesis import strategies as st

from guidance_app.console.wheel import ANSWER_S, Helm, Wheel
from guidance_app.console.wheel_strip import wheel_words
from guidance_app.language import ENGLISH

FIRST, SECOND, THIRD = 10, 11, 12
STEPS = st.lists(
    st.tuples(
        st.sampled_from(["came", "left", "ask", "give", "keep", "wait"]), st.sampled_from([FIRST, SECOND, THIRD])
    ),
    max_size=40,
)


def three() -> Wheel:
    return Wheel().came(FIRST).came(SECOND).came(THIRD)


@given(steps=STEPS)
def test_whatever_happens_the_holder_is_there_and_so_is_who_asks(steps: list[tuple[str, int]]) -> None:
    now = itertools.count(0.0, 3.0)
    clock = [0.0]
    helm = Helm(lambda: clock[0])
    there: set[int] = set()
    for what, client in steps:
        clock[0] = next(now)
        if what == "came":
            helm.came(client)
            there.add(client)
        elif what == "left":
            helm.left(client)
            there.discard(client)
        elif what == "wait":
            clock[0] += ANSWER_S
        else:
            getattr(helm, what)(client)
        holders = [one for one in (FIRST, SECOND, THIRD) if helm.has(one)]
        assert len(holders) <= 1
        assert set(holders) <= there
        views = [helm.view(one) for one in there]
        assert len({view.number for view in views}) == len(there)
        if len(there) == 1:
            assert holders == list(there), "a single tablet always operates"
        for view in views:
            assert view.asking is None or view.asking != view.holder


def test_the_first_has_it_and_alone_nobody_hears_of_it() -> None:
    wheel = Wheel().came(FIRST)
    assert wheel.view(FIRST, 0.0).mine
    assert wheel_words(wheel.view(FIRST, 0.0), ENGLISH) == ""
    assert not wheel.came(SECOND).view(SECOND, 0.0).mine


def test_given_kept_and_free_after_ten_seconds() -> None:
    asked = three().asks(SECOND, 5.0)
    assert asked.gives(FIRST).holder == SECOND
    assert asked.keeps(FIRST).holder == FIRST
    assert asked.keeps(FIRST).asking is None
    assert asked.at(5.0 + ANSWER_S - 0.1).holder == FIRST
    assert asked.at(5.0 + ANSWER_S).holder == SECOND


def test_nobody_else_can_give_keep_or_ask_meanwhile() -> None:
    asked = three().asks(SECOND, 0.0)
    assert asked.gives(THIRD) == asked
    assert asked.keeps(SECOND) == asked
    assert asked.asks(THIRD, 1.0) == asked
    assert asked.asks(FIRST, 1.0) == asked


def test_when_the_holder_goes_who_asks_has_it_else_it_is_free() -> None:
    assert three().asks(THIRD, 0.0).left(FIRST).holder == THIRD
    free = three().left(FIRST)
    assert free.holder is None
    assert free.asks(THIRD, 1.0).holder == THIRD
    assert free.left(SECOND).holder == THIRD
    assert free.came(FIRST).holder == FIRST


def test_who_asks_and_goes_asks_no_more() -> None:
    assert three().asks(SECOND, 0.0).left(SECOND).asking is None


def test_what_each_reads() -> None:
    wheel = three()
    assert wheel_words(wheel.view(FIRST, 0.0), ENGLISH) == "You have the wheel; 2 tablets follow."
    assert wheel_words(wheel.view(SECOND, 0.0), ENGLISH) == "Tablet 1 has the wheel; this one follows."
    asked = wheel.asks(SECOND, 0.0)
    assert wheel_words(asked.view(FIRST, 4.0), ENGLISH) == "Tablet 2 wants the wheel; it has it in 6 s."
    assert wheel_words(asked.view(SECOND, 4.0), ENGLISH) == "Asked for the wheel: 6 s."
    assert wheel_words(wheel.left(FIRST).view(SECOND, 0.0), ENGLISH) == "Nobody has the wheel."


def test_numbers_are_used_again() -> None:
    assert three().left(SECOND).came(99).view(99, 0.0).number == 2
