"""The case studies on a real ROS 1."""

import pytest
from demo_battery import DemoBattery, run_study

from rtron.demos.cases import CASES

pytestmark = [pytest.mark.ros1, pytest.mark.long, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return run_study(1, tmp_path_factory.mktemp("demo") / "all", CASES, (1, 2))


class TestDemo(DemoBattery):
    ros = 1
