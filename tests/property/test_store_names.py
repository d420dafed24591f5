"""Names of any script and length have a safe file of their own."""

import string
import tempfile
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from guidance_app.documents import Tractor
from guidance_app.store import Store
from guidance_app.store.files import safe_stem

SAFE = set(string.ascii_lowercase + string.digits + "-")
LONGEST_FILE_NAME = 143
"""Bytes; what folders with encrypted names allow."""

names = st.text(st.characters(exclude_categories=("Cs", "Cc")), min_size=1, max_size=120).filter(str.strip)
awkward = st.sampled_from(
    ["../../etc/passwd", "CON", "nul", "a/b", "a\\b", "..", ".", "<b>x</b>", "圃場 一号", "مزرعة", "é", "e\u0301", "🚜"]
)


@given(names | awkward)
def test_every_name_gives_a_file_name_that_is_safe_everywhere(name: str) -> None:
    for stem in (safe_stem(name), safe_stem(name, distinct=True)):
        assert stem
        assert set(stem) <= SAFE
        assert len(f".{stem}.json.broken.tmp".encode()) <= LONGEST_FILE_NAME
        assert not stem.startswith("-")
        assert stem.upper() not in {"CON", "PRN", "AUX", "NUL", "COM1", "LPT1"}


@settings(max_examples=40, deadline=None)
@given(st.lists(names | awkward, min_size=2, max_size=5))
def test_documents_with_different_names_never_share_a_file(wanted: list[str]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        store = Store(Path(folder))
        documents = {each.name: each for each in (Tractor(name=name) for name in wanted)}
        for document in documents.values():
            store.save(document)
        assert {each.document.name for each in store.list(Tractor)} == set(documents)
        for name, document in documents.items():
            assert store.load(Tractor, name).document == document


def test_names_that_differ_in_case_alone_live_side_by_side(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.save(Tractor(name="Big One"))
    store.save(Tractor(name="big one"))
    assert len(store.list(Tractor)) == 2
    assert len({path.name.lower() for path in (tmp_path / "tractors").iterdir()}) == 2
