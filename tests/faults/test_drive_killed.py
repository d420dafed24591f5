"""A drive that is killed while it is recorded loses nothing that was safe, and can be gone on with every time."""

import json
import os
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).parent.parent
KILLS = 20
SLOW_KILLS = 2


def test_a_drive_killed_over_and_over_loses_nothing_that_was_safe(tmp_path: Path) -> None:
    program = TESTS / "support" / "killed_drive.py"
    paths = os.pathsep.join([str(TESTS), str(TESTS.parent)])
    done = subprocess.run(
        [sys.executable, str(program), str(tmp_path / "data"), str(KILLS), str(SLOW_KILLS), "7"],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["lost"] == []
    assert result["kills"] == KILLS + SLOW_KILLS
    assert result["resumable"] >= KILLS // 2
    assert result["commands"] > 0
    assert result["longest"] > 100
