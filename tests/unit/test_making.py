"""Records that are made quickly are what the same dataclass would be without it."""

import copy
import pickle
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace

import pytest

from guidance_app.model import Fix, FixQuality, LinkState, Snapshot
from guidance_app.model.making import made_quickly


@made_quickly
@dataclass(frozen=True, slots=True)
class Quick:
    """A record with every kind of member."""

    number: int
    word: str = "none"
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Plain:
    """The same, made as usual."""

    number: int
    word: str = "none"
    notes: list[str] = field(default_factory=list)


def _members(record: object) -> list[object]:
    return [getattr(record, one.name) for one in fields(record)]  # type: ignore[arg-type]  # one of the two above


@pytest.mark.parametrize(
    ("given", "named"), [((1,), {}), ((1, "two"), {}), ((1,), {"notes": ["a"]}), ((), {"word": "w", "number": 3})]
)
def test_it_holds_what_the_plain_one_holds(given: tuple[int], named: dict[str, str]) -> None:
    quick, plain = Quick(*given, **named), Plain(*given, **named)  # type: ignore[arg-type]  # several signatures at once
    assert type(quick) is Quick
    assert _members(quick) == _members(plain)
    assert repr(quick) == repr(plain).replace("Plain", "Quick")
    assert replace(quick, word="x") == Quick(quick.number, "x", quick.notes)


def test_each_gets_members_of_its_own_by_default() -> None:
    assert Quick(1).notes is not Quick(1).notes


def test_it_is_frozen_and_has_no_other_members() -> None:
    record = Quick(1)
    with pytest.raises(FrozenInstanceError):
        record.number = 2  # type: ignore[misc]  # the very thing that is refused
    assert not hasattr(record, "__dict__")


@pytest.mark.parametrize("named", [{}, {"number": 1, "other": 2}])
def test_wrong_members_are_refused(named: dict[str, int]) -> None:
    with pytest.raises(TypeError, match=r"Quick\.__init__|__init__"):
        Quick(**named)  # type: ignore[arg-type]  # the very thing that is refused


def test_copies_and_pickles_are_equal() -> None:
    fix = Fix(1.0, 2.0, 52.0, 11.0, FixQuality.DGPS, cell=(0.1, 0.2))
    assert copy.copy(fix) == fix
    assert pickle.loads(pickle.dumps(fix)) == fix
    assert hash(fix) == hash(Fix(1.0, 2.0, 52.0, 11.0, FixQuality.DGPS, cell=(0.1, 0.2)))


def test_a_snapshot_has_its_defaults() -> None:
    snapshot = Snapshot(0, 0.0, LinkState())
    assert snapshot.links_beside == {}
    assert snapshot.totals.worked == 0.0
    assert snapshot.sections == (True,)


def test_more_than_a_record_is_refused() -> None:
    class Child(Plain):
        """Inherits its members."""

    @dataclass(frozen=True, slots=True)
    class Checked:
        """Looks at what it was given."""

        number: int

        def __post_init__(self) -> None:
            """Nothing."""

    for kind in (Child, Checked):
        with pytest.raises(TypeError, match="more than a record"):
            made_quickly(kind)
