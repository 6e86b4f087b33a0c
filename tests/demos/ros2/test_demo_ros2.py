"""The case studies on a real ROS 2."""

import re
from contextlib import suppress
from pathlib import Path

import pytest
from demo_battery import SPEED, DemoBattery, run_study
from harness import wait_for
from rmw_marks import RMW

from rtron.demos.runtime.app_launch import launch_app
from rtron.demos.runtime.environment import demo_environment
from rtron.demos.runtime.isolation import launch_file

pytestmark = [pytest.mark.ros2, pytest.mark.long, pytest.mark.timeout(600)]
OWN_SEGMENT = re.compile(r"(/dev/shm/fastdds_[0-9a-f]{16})_el")
"""What a process holds open of the segments that it has made; it also maps those of others."""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return run_study(2, tmp_path_factory.mktemp("demo") / "gr", ["gr"], (1, 2, 3))


class TestDemo(DemoBattery):
    ros = 2


def shared_memory(app):
    """Return the segments of Fast DDS that the app's processes have made."""
    opened = (path for each in app.started.values() for path in open_files(each.popen.pid))
    return [Path(match[1]) for match in map(OWN_SEGMENT.fullmatch, opened) if match]


def open_files(pid):
    """Return the paths of what a process has open."""
    for descriptor in Path("/proc", str(pid), "fd").iterdir():
        with suppress(FileNotFoundError):  # it was closed meanwhile
            yield str(descriptor.readlink())


def test_the_app_leaves_no_shared_memory_behind(tmp_path):
    with demo_environment(2, tmp_path, speed=SPEED) as demo:
        with launch_app(demo, launch_file(2)) as app:
            kept = shared_memory(app)
        assert len(kept) >= len(app.started) or not RMW.startswith("rmw_fastrtps")
        wait_for(lambda: not any(path.exists() for path in kept), what=f"an end of {kept}")
