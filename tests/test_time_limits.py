"""A test that hangs ends its process, and shows where it hangs."""

import subprocess
import sys
from pathlib import Path

HANGING = """
import threading
import pytest

@pytest.fixture(autouse=True)
def slow():
    yield
    threading.Event().wait(600)

@pytest.mark.timeout(0.2)
def test_it_hangs():
    pass
"""


def test_a_test_that_hangs_ends_and_shows_its_stack(tmp_path):
    (tmp_path / "test_hanging.py").write_text(HANGING)
    command = (sys.executable, "-m", "pytest", "-p", "time_limits", "-p", "no:hypothesispytest")
    ran = subprocess.run(
        (*command, "--rootdir", tmp_path, "-c", "/dev/null", tmp_path),
        env={"PYTHONPATH": str(Path(__file__).parent)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 1
    assert "threading.Event().wait(600)" in ran.stdout
