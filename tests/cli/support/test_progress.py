"""Progress on a terminal, and in a log."""

import os
import pty
import subprocess
import sys

from rtron.cli.support.progress import LINE_INTERVAL_S, progress_lines

SHOW = """
from rtron.cli.support.progress import show_progress
with show_progress() as progress:
    progress(1, 2, "one\\x1b[31m")
    progress(2, 2, "two")
"""


def test_a_log_gets_a_line_now_and_then():
    times = iter([0.0, 1.0, LINE_INTERVAL_S, LINE_INTERVAL_S, LINE_INTERVAL_S + 1])
    lines = []
    progress = progress_lines(lines.append, lambda: next(times))
    for done in (1, 2, 3):
        progress(done, 9, f"app\n{done}")
    assert lines == ["2 of 9: app\\n2"]


def test_a_terminal_gets_a_bar_with_how_much_is_done():
    reading, terminal = pty.openpty()
    ran = subprocess.run([sys.executable, "-c", SHOW], stderr=terminal, check=True, timeout=60)
    os.close(terminal)
    shown = os.read(reading, 65536).decode()
    os.close(reading)
    assert ran.returncode == 0
    assert "2/2" in shown
    assert "\x1b[31m" not in shown


def test_what_is_no_terminal_gets_nothing_at_once():
    ran = subprocess.run(
        [sys.executable, "-c", SHOW], capture_output=True, check=True, timeout=60, text=True
    )
    assert ran.stderr == ""
