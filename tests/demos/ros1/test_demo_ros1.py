"""The case studies on a real ROS 1."""

import pytest
from demo_battery import DemoBattery, run_study

from rtron.demos.cases import CASES

pytestmark = [pytest.mark.ros1, pytest.mark.long, pytest.mark.timeout(600)]


STUDIES = {"without rsr": (["gr", "msr", "agent"], (1, 2, 3)), "all cases": (CASES, (1,))}


@pytest.fixture(scope="module", params=STUDIES.values(), ids=STUDIES)
def study(request, tmp_path_factory):
    return run_study(1, tmp_path_factory.mktemp("demo") / "study", *request.param)


class TestDemo(DemoBattery):
    ros = 1
