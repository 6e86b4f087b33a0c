"""The tests of SROS2 on Cyclone DDS, where its RMW is there (mark.ros2)."""

from pathlib import Path

import pytest
from cyclone_rmw import run_on_cyclone, runs_others

LIMIT_S = 600
pytestmark = [*runs_others, pytest.mark.timeout(LIMIT_S)]


def test_enforce_keeps_intruders_out_on_cyclone_dds():
    run_on_cyclone(Path(__file__).with_name("test_enforce_ros2.py"), LIMIT_S)
