"""The demo on a real ROS 2: it drives, is attacked, is guarded, and ends whole."""

import re
from contextlib import suppress
from pathlib import Path

import pytest
from launched_demo import SPEED, check_guarded, guarded_run, wait_until_gone
from rmw_marks import RMW

from rtron.demos.runtime.app_files import launch_file
from rtron.demos.runtime.app_launch import launch_app
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.instrumentation import InstrumentationPipeline
from rtron.demos.runtime.service import run_service

pytestmark = pytest.mark.ros2


OWN_SEGMENT = re.compile(r"(/dev/shm/fastdds_[0-9a-f]{16})_el")
"""What a process holds open of the segments that it has made; it also maps those of others."""


def shared_memory(app):
    """Return the segments of Fast DDS that the app's processes have made."""
    opened = (path for each in app.started.values() for path in open_files(each.popen.pid))
    return [Path(match[1]) for match in map(OWN_SEGMENT.fullmatch, opened) if match]


def open_files(pid):
    """Return the paths of what a process has open."""
    for descriptor in Path("/proc", str(pid), "fd").iterdir():
        with suppress(FileNotFoundError):  # it was closed meanwhile
            yield str(descriptor.readlink())


@pytest.mark.long
def test_the_guarded_app_is_not_harmed(tmp_path):
    """Once in some thirty starts no node of the app hears anything any more; why is not known."""
    with (
        demo_environment(2, tmp_path, speed=SPEED) as demo,
        run_service(demo.processes, tmp_path / "service", demo.environ) as service,
    ):
        pipeline = InstrumentationPipeline(demo, tmp_path / "guarded")
        with launch_app(demo, launch_file(2)) as app:
            pipeline.scan()
            kept = shared_memory(app)
        assert len(kept) >= len(app.started) or not RMW.startswith("rmw_fastrtps")
        wait_until_gone(kept)
        check_guarded(demo, *guarded_run(demo, pipeline, service))
