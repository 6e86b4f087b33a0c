"""The demo on a real ROS 1: it drives, is attacked, is guarded, and ends whole."""

import pytest
from launched_demo import SPEED, check_guarded, guarded_run

from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.runtime.service import run_service

pytestmark = [pytest.mark.ros1, pytest.mark.long]


def test_the_guarded_app_is_not_harmed(tmp_path):
    with (
        demo_environment(1, tmp_path, speed=SPEED) as demo,
        run_service(demo.processes, tmp_path / "service", demo.environ) as service,
    ):
        pipeline = InstrumentationPipeline(demo, tmp_path / "guarded")
        pipeline.scan()
        check_guarded(demo, *guarded_run(demo, pipeline, service))
    commands = [said.command.split()[1] for said in pipeline.commands]
    assert commands == ["scan", "scan", "plan", "check", "instrument"]
    assert "/tb3_safe_control both drive the robot on /cmd_vel" in pipeline.commands[1].text
