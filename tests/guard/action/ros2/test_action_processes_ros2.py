"""A guarded action with every part a process: remapped nodes, the guard and its supervisor."""

import os
import re
import signal

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from harness import wait_for

from rtron.vocabulary import Ros2ActionEntity, ros2_entity_name

pytestmark = [pytest.mark.ros2, pytest.mark.long]

PLAN = """\
app: fib
ros: 2
grcn:
  - topic: /fib
    type: test_msgs/action/Fibonacci
    mode: enforce
    policy: FIFO_Queue
    max_age: 60 s
    flows: [{name: flow1, publisher: /one}, {name: flow2, publisher: /two}]
    successors: [/server]
"""


def remaps(private):
    return [
        f"{ros2_entity_name('/fib', end)}:={ros2_entity_name(private, end)}"
        for end in Ros2ActionEntity
    ]


LONG_LEASE = """\
<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com">
  <participant profile_name="long" is_default_profile="true">
    <rtps><builtin><discovery_config>
      <leaseDuration><sec>3600</sec></leaseDuration>
    </discovery_config></builtin></rtps>
  </participant>
</profiles>
"""


@pytest.fixture
def never_forgetting(ros2):
    """Have a domain in which who is killed stays listed: its lease outlasts the test."""
    profiles = ros2.folder / "profiles.xml"
    profiles.write_text(LONG_LEASE)
    ros2.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(profiles)  # newer ones know it, too
    return ros2


def guards(supervisor):
    """Return the guards that a supervisor has started, by what it says."""
    return [int(pid) for pid in re.findall(r"the guard begins, process (\d+)", supervisor.log)]


def client_one(ros2, *orders):
    """Start the approved client /one."""
    return ros2.node("fibonacci_client.py", *orders, name="/one", remaps=remaps("/rtron/fib/flow1"))


def fibonacci_server(ros2, *arguments):
    """Start the server of the plan."""
    server_remaps = remaps("/rtron/fib/out")
    return ros2.node("fibonacci_server.py", *arguments, name="/server", remaps=server_remaps)


def test_a_guard_that_is_killed_mid_goal_costs_no_answer(ros2, tmp_path):
    plan, finish = tmp_path / "rtron.yaml", tmp_path / "finish"
    plan.write_text(PLAN)
    server = fibonacci_server(ros2, finish)
    guard = ros2.rtron("guard", "--plan", plan)
    one = client_one(ros2, 0, 4000, 7)
    wait_for(lambda: "started 4000" in server.log, what="the long goal")
    eve = ros2.node("fibonacci_client.py", 9, name="/eve")
    wait_for(lambda: "9 rejected" in eve.log, what="a stranger's goal to be rejected")
    before, found = guards(guard), guard.log.count("the server /server is there")
    os.kill(before[-1], signal.SIGKILL)
    wait_for(lambda: guard.log.count("the server /server is there") > found, what="the next guard")
    finish.touch()
    wait_for(lambda: "done" in one.log, what="the answers", limit_s=60)
    assert one.log.splitlines() == ["ready", "0 4 [0]", "4000 4 [4000]", "7 4 [7]", "done"]
    assert "started 9" not in server.log
    assert len(guards(guard)) == len(before) + 1


@pytest.mark.long
def test_who_follows_on_a_killed_server_and_a_killed_client_is_heard_at_once(never_forgetting):
    ros2 = never_forgetting
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    first, guard = fibonacci_server(ros2), ros2.rtron("guard", "--plan", plan)
    client = client_one(ros2, 0, 400)
    wait_for(lambda: "started 400" in first.log, what="the long goal")
    for each in (client, first):
        each.tell(signal.SIGKILL)
        wait_for(lambda each=each: each.ended, what="an end")
    wait_for(lambda: "the server /server is gone" in guard.log, what="its loss", limit_s=60)
    second = fibonacci_server(ros2)
    wait_for(lambda: guard.log.count("the server /server is there") == 2, what="the next server")
    client = client_one(ros2, 7)
    wait_for(lambda: "done" in client.log, what="the answer", limit_s=60)
    assert "7 4 [7]" in client.log
    assert "started 7" in second.log
