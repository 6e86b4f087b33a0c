"""Pictures of megabytes through the guard, and commands beside them that must not wait."""

import os
import re
import signal
import time
from pathlib import Path

import pytest
from bulk_load import MOST_DELAY, commands_beside_pictures
from harness import lives, wait_for
from rmw_marks import needs_fast_dds
from ros2_plans import driving, telling, written

from rtron.guard.lanes.bulk.stand_still import LONGEST_STAND
from rtron.vocabulary import SECOND, flow_topic, output_topic

pytestmark = pytest.mark.ros2
PICTURE_RATE = 10
PLAN = written(
    driving("nav", silent_after=8 * SECOND),
    telling("/image", "sensor_msgs/msg/Image", "/viewer", "camera"),
)
NAV, OUT = flow_topic("/cmd_vel", "nav"), output_topic("/cmd_vel")
PICTURE, SEEN = flow_topic("/image", "camera"), output_topic("/image")


def last_count(log, topic):
    """Return how many messages of a topic were heard, and the longest gap between two, s."""
    found = re.findall(rf"heard {re.escape(topic)} (\d+) (\S+)", log)
    return (int(found[-1][0]), float(found[-1][1])) if found else (0, 0.0)


@pytest.fixture
def guard(ros2):
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    wait_for(lambda: "guarding 2 topics" in guard.log or guard.ended, what="the guard")
    assert not guard.ended, guard.log
    return guard


@pytest.fixture
def base(ros2, guard):
    """Return the driver, which hears the navigation before and behind the guard."""
    ends = (f"{NAV}=geometry_msgs/Twist", f"{OUT}=geometry_msgs/Twist")
    driver = ros2.node("gap_meter.py", *ends, name="/driver")
    ros2.node("twist_publisher.py", NAV, "0.5", "20", name="/nav")
    wait_for(lambda: last_count(driver.log, OUT)[0] > 50, what="the navigation")
    return driver


def test_commands_do_not_wait_for_pictures(ros2):
    """Long: pictures of megabytes take both cores while the base hears 300 commands."""
    heard, longest_gap = commands_beside_pictures(ros2.environ, ros2.folder, ros=2)
    assert longest_gap <= MOST_DELAY
    assert heard.unguarded() == []


@pytest.mark.long
@needs_fast_dds("Cyclone DDS uses no shared memory here")
def test_what_carries_commands_never_waits_for_shared_memory(guard):
    """Whoever opens that of a process that stands still hears nothing meanwhile."""
    shares = {name: "/dev/shm/fastdds_" in maps for name, maps in programs_of(guard)}
    assert shares == {
        "rtron-superviso": False,
        "rtron-forks": False,
        "rtron-guard": False,
        "rtron-bulk": True,
    }


def programs_of(guard):
    """Give each program of the guard, the supervisor first, and the files in its memory."""
    (server,) = children(guard.pid)
    for pid in (guard.pid, server, *children(server)):
        name = Path(f"/proc/{pid}/comm").read_text().strip()
        yield name, Path(f"/proc/{pid}/maps").read_text()


def children(pid):
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


def bulk_process(guard):
    """Return the process that carries pictures, as the log says."""
    return int(re.findall(r"the bulk process is there, process (\d+)", guard.log)[-1])


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_commands_go_on_without_the_process_of_the_pictures(ros2, guard, base, number):
    pid = bulk_process(guard)
    before = [last_count(base.log, topic)[0] for topic in (NAV, OUT)]
    os.kill(pid, number)
    wait_for(lambda: not lives(pid), what="the end of the bulk process")
    wait_for(lambda: bulk_process(guard) != pid, what="the next bulk process")
    said, heard = (last_count(base.log, topic)[0] for topic in (NAV, OUT))
    assert heard - before[1] > (said - before[0]) / 2
    viewer = ros2.node("gap_meter.py", f"{SEEN}=sensor_msgs/Image", name="/viewer")
    ros2.node("image_publisher.py", PICTURE, 1000, PICTURE_RATE, name="/camera")
    wait_for(lambda: last_count(viewer.log, SEEN)[0] > 3, what="pictures behind the next one")
    assert guard.log.count("the guard begins") == 1


@pytest.mark.long
def test_a_process_that_stood_still_is_followed_by_another(ros2, guard):
    """It is shorter than what the command process takes for a hang."""
    pid = bulk_process(guard)
    os.kill(pid, signal.SIGSTOP)
    time.sleep(1.2 * LONGEST_STAND / SECOND)
    os.kill(pid, signal.SIGCONT)
    wait_for(lambda: bulk_process(guard) != pid, what="the next bulk process")
    assert "stood still for" in guard.log
