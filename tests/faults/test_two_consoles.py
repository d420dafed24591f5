"""Two consoles on one data folder never overwrite each other's changes."""

import os
import subprocess
import sys
from pathlib import Path

from support.documents import field_named

from guidance_app.documents import FieldDocument
from guidance_app.store import Store

TESTS = Path(__file__).parent.parent
TIMES = 60


def test_two_programs_that_count_in_one_document_lose_no_step(tmp_path: Path) -> None:
    Store(tmp_path).save(field_named("Counter", "0"))
    paths = os.pathsep.join([str(TESTS), str(TESTS.parent)])
    command = [sys.executable, str(TESTS / "support" / "counting_writer.py"), str(tmp_path), str(TIMES)]
    programs = [
        subprocess.Popen(
            [*command, name],
            env={**os.environ, "PYTHONPATH": paths},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for name in ("left", "right")
    ]
    for program in programs:
        assert program.stdout is not None
        assert program.stdout.readline() == "ready\n"
    for program in programs:
        assert program.stdin is not None
        program.stdin.write("begin\n")
        program.stdin.flush()
    counted = [program.communicate()[0].split() for program in programs]
    assert [program.returncode for program in programs] == [0, 0]
    notes = Store(tmp_path).load(FieldDocument, "Counter").document.notes
    assert int(notes.split()[0]) == sum(int(steps) for steps, _ in counted)
    assert sum(int(conflicts) for _, conflicts in counted) > 0, "the programs never met, so nothing was tested"
