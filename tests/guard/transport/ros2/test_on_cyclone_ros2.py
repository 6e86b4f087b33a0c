"""The same tests of the transport on Cyclone DDS, where somebody has built its RMW for the wheels.

`RTRON_RMW_CYCLONEDDS` names the folder whose `env.sh` chooses it.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from rmw_marks import RMW

FOLDER = os.environ.get("RTRON_RMW_CYCLONEDDS", "")
TESTS = Path(__file__).parent.parent
LIMIT_S = 900
pytestmark = [
    pytest.mark.ros2,
    pytest.mark.timeout(LIMIT_S),
    pytest.mark.skipif(not FOLDER, reason="RTRON_RMW_CYCLONEDDS names no RMW of Cyclone DDS"),
    pytest.mark.skipif("cyclonedds" in RMW, reason="these tests run on Cyclone DDS already"),
]


def environ_of(folder):
    """Return the environment that a folder's env.sh makes of this one."""
    command = ["bash", "-c", '. "$1" && exec env -0', "bash", str(Path(folder, "env.sh"))]
    told = subprocess.run(command, capture_output=True, check=True, text=True).stdout
    return dict(line.split("=", 1) for line in told.split("\0") if line)


def test_the_transport_keeps_to_its_contract_on_cyclone_dds():
    environ = environ_of(FOLDER)
    assert "cyclonedds" in environ["RMW_IMPLEMENTATION"]
    command = [sys.executable, "-m", "pytest", "-m", "ros2", "-q", "-p", "no:cacheprovider"]
    ran = subprocess.run(
        [*command, str(TESTS)],
        env=environ | {"PYTEST_ADDOPTS": ""},
        cwd=TESTS.parents[2],
        capture_output=True,
        check=False,
        text=True,
        timeout=LIMIT_S,
    )
    assert ran.returncode == 0, ran.stdout
    assert " passed" in ran.stdout
