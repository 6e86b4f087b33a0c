"""Cyclone DDS as the RMW, where somebody has built it for the wheels: with DDS-Security.

`RTRON_RMW_CYCLONEDDS` names the folder whose `env.sh` chooses it.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from rmw_marks import RMW

FOLDER = os.environ.get("RTRON_RMW_CYCLONEDDS", "")
ROOT = Path(__file__).parents[2]
IS_CYCLONE = "cyclonedds" in RMW
runs_others = [
    pytest.mark.ros2,
    pytest.mark.skipif(not FOLDER, reason="RTRON_RMW_CYCLONEDDS names no RMW of Cyclone DDS"),
    pytest.mark.skipif(IS_CYCLONE, reason="these tests run on Cyclone DDS already"),
]
"""The marks of a test that runs others on Cyclone DDS."""
needs_security = pytest.mark.skipif(
    not IS_CYCLONE, reason="the RMW has no DDS-Security: see RTRON_RMW_CYCLONEDDS"
)


def environ_of(folder):
    """Return the environment that a folder's env.sh makes of this one."""
    command = ["bash", "-c", '. "$1" && exec env -0', "bash", str(Path(folder, "env.sh"))]
    told = subprocess.run(command, capture_output=True, check=True, text=True).stdout
    return dict(line.split("=", 1) for line in told.split("\0") if line)


def run_on_cyclone(path, limit):
    """Run the tests at a path on Cyclone DDS, within `limit` seconds; some have to pass."""
    environ = environ_of(FOLDER)
    assert "cyclonedds" in environ["RMW_IMPLEMENTATION"]
    command = [sys.executable, "-m", "pytest", "-m", "ros2", "-q", "-p", "no:cacheprovider"]
    ran = subprocess.run(
        [*command, str(path)],
        env=environ | {"PYTEST_ADDOPTS": ""},
        cwd=ROOT,
        capture_output=True,
        check=False,
        text=True,
        timeout=limit,
    )
    assert ran.returncode == 0, ran.stdout
    assert " passed" in ran.stdout
