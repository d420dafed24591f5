"""A writer killed in the middle of writing never loses what it has said is stored."""

import json
import os
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).parent.parent
KILLS = 500


def test_a_writer_killed_500_times_never_loses_an_acknowledged_document(tmp_path: Path) -> None:
    program = TESTS / "support" / "killed_writer.py"
    paths = os.pathsep.join([str(TESTS), str(TESTS.parent)])
    done = subprocess.run(
        [sys.executable, str(program), str(tmp_path / "data"), str(KILLS), "20130"],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=250,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["lost"] == []
    assert result["kills"] == KILLS
    assert result["said"] > KILLS
    # The test would be empty if no kill had ever struck in the middle of a write.
    assert result["unfinished"] > KILLS // 20
