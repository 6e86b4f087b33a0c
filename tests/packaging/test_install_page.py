"""docs/install.md, followed to the letter, after the installation itself."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BLOCKS = re.findall(r"```sh\n(.*?)```", (ROOT / "docs" / "install.md").read_text(), re.DOTALL)
COMMANDS = {"rtron": '-m rtron "$@"', "python": '"$@"'}

_HEAD = "set -e; trap 'kill $(jobs -p) || true' EXIT"
_OWN_DOMAIN = "ROS_DOMAIN_ID=42 "


@pytest.mark.ros2
@pytest.mark.long
def test_a_stranger_gets_to_a_guarded_app(ros2, tmp_path):
    install, *blocks = BLOCKS
    assert 'pip install "./rtron[ros2]"' in install
    for name, words in COMMANDS.items():
        program = tmp_path / "bin" / name
        program.parent.mkdir(exist_ok=True)
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" {words}\n')
        program.chmod(0o755)
    script = "\n".join([_HEAD, *blocks]).replace(_OWN_DOMAIN, "")
    environment = ros2.environ | {"PATH": f"{tmp_path / 'bin'}:{ros2.environ['PATH']}"}
    ran = subprocess.run(
        ["bash", "-c", script],
        cwd=tmp_path,
        env=environment | {"PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    unguarded = set((tmp_path / "unguarded.log").read_text().splitlines())
    assert unguarded == {"forward 0.2, turn 0.0", "forward 0.0, turn -2.0"}
    assert "3 planned paths" in ran.stdout
    guarded = (tmp_path / "guarded.log").read_text().splitlines()
    assert "forward 0.2, turn 0.0" in guarded
    assert set(guarded[-20:]) <= {"forward 0.2, turn 0.0", "forward 0.0, turn 0.0"}
