"""The demo on a real ROS 2: it drives, is attacked, is guarded, and ends whole."""

import re
from pathlib import Path

import pytest
from launched_demo import (
    SPEED,
    check_guarded,
    guarded_run,
    wait_until_gone,
)

from rtron.demos.runtime.app_files import launch_file
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.runtime.service import run_service

pytestmark = pytest.mark.ros2


def shared_memory(app):
    """Return the segments of Fast DDS that belong to the app's processes alone."""
    names = set()
    for started in app.started.values():
        text = Path("/proc", str(started.popen.pid), "maps").read_text()
        names |= set(re.findall(r"/dev/shm/fastdds_[0-9a-f]{16}", text))
    return [Path(name) for name in names]


def test_the_guarded_app_is_not_harmed(tmp_path):
    with (
        demo_environment(2, tmp_path, speed=SPEED) as demo,
        run_service(demo.processes, tmp_path / "service", demo.environ) as service,
    ):
        pipeline = InstrumentationPipeline(demo, tmp_path / "guarded")
        with demo.launch_app(launch_file(2)) as app:
            pipeline.scan()
            kept = shared_memory(app)
        assert len(kept) >= len(app.started)
        wait_until_gone(kept)
        check_guarded(demo, *guarded_run(demo, pipeline, service))
