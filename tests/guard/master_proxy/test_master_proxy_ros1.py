"""`rtron master` before a real one: the guarded app works, who goes past the plan is refused."""

import json
import os
import signal
import sys
from pathlib import Path

import pytest
from driven_base import CMD_VEL, CMD_VEL_GUARD, Base, Driven, drive_plan, start_guard, write_app
from harness import Ros1, named, wait_for
from plans import grcn, plan_of
from proxied_master import start
from rostopic import TWIST, TopicEcho, say

from rtron.errors import RTronError
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import SUPERVISOR_NODE
from rtron.wire.ros1.xmlrpc import call, ros_call

pytestmark = pytest.mark.ros1
OUT, FLOW1 = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"
REFUSED = "refused by rtron master"
TYPE = "geometry_msgs/Twist"
LIMIT_S, NOWHERE = 30.0, "http://localhost:1/"


@pytest.fixture
def inside(ros1):
    return start(ros1, drive_plan())


@pytest.fixture
def base(inside, driver):
    return Base(inside, driver, guarded=True)


@pytest.fixture(scope="module")
def moving_base(tmp_path_factory, driver):
    """A base that navigation drives, for tests that leave it as they find it."""
    with Ros1(tmp_path_factory.mktemp("driven")) as ros1:
        base = Base(start(ros1, drive_plan()), driver, guarded=True)
        base.navigate()
        yield base


def public(inside):
    return inside.environ["ROS_MASTER_URI"]


def refused(inside, method, *params):
    code, message, _ = call(public(inside), method, *params, timeout=LIMIT_S)
    return code == -1 and REFUSED in message


def assert_only_navigation_arrives(base):
    base.wait_for_navigation()
    base.driven.assert_navigation_is_whole()
    assert base.driven.turns() == 0


def assert_only_the_guard_publishes(base):
    assert {CMD_VEL_GUARD} <= base.ros1.publishers(OUT) <= {CMD_VEL_GUARD, SUPERVISOR_NODE}


@pytest.mark.parametrize(
    ("name", "topic"),
    [
        ("/by_hand", CMD_VEL),
        ("/by_hand", OUT),
        ("/by_hand", FLOW1),
        ("/rogue", FLOW1),
        ("/rogue", OUT),
        (CMD_VEL_GUARD, OUT),
        ("/rtron_supervisor", OUT),
    ],
)
def test_a_rogue_is_told_and_nothing_of_it_arrives(moving_base, name, topic):
    base, logged = moving_base, len(moving_base.ros1.master.log)
    before = base.ros1.publishers(topic) | {SUPERVISOR_NODE}
    rogue = base.ros1.node("rogue.py", name, "1000", f"{CMD_VEL}:={topic}")
    told = f"unable to register publication [{topic}] with master: {REFUSED}"
    wait_for(lambda: told in rogue.log, what="the rogue's error")
    count = len(base.driven.navigation()) + 10
    wait_for(lambda: len(base.driven.navigation()) >= count, what="a second of navigation")
    assert_only_navigation_arrives(base)
    assert base.ros1.publishers(topic) <= before
    assert base.ros1.received(CMD_VEL_GUARD, CMD_VEL) == 0
    assert f"refused: registerPublisher to '{name}'" in base.ros1.master.log[logged:]
    rogue.kill()


@pytest.mark.long
def test_a_rogue_in_cpp_is_refused_too(base):
    base.navigate()
    say(base.ros1, "talker", "/chatter", TYPE, TWIST % 5)
    rogue = base.ros1.spawn("/usr/lib/topic_tools/relay", "/chatter", OUT, *named("/relay"))
    told = f"registerPublisher to '/relay': the plan does not let /relay publish {OUT}"
    wait_for(lambda: told in base.ros1.master.log, what="the proxy's refusal")
    assert_only_navigation_arrives(base)
    assert not rogue.ended
    assert_only_the_guard_publishes(base)


def test_the_guard_works_as_ever_and_is_not_shut_down_by_its_name(moving_base):
    base = moving_base
    guard_at = base.ros1.uri_of(CMD_VEL_GUARD)
    base.ros1.node("nav.py", CMD_VEL_GUARD)
    wait_for(lambda: "guard's names" in base.ros1.master.log, what="the proxy's refusal")
    assert_only_navigation_arrives(base)
    assert base.ros1.uri_of(CMD_VEL_GUARD) == guard_at
    for topic in (OUT, "/cmd_vel"):
        assert refused(base.ros1, "unregisterPublisher", CMD_VEL_GUARD, topic, guard_at)
    assert_only_the_guard_publishes(base)


@pytest.mark.long
def test_a_guard_that_is_killed_comes_back_behind_the_proxy(base):
    base.navigate()
    os.kill(base.ros1.ask(base.ros1.uri_of(CMD_VEL_GUARD), "getPid"), signal.SIGKILL)
    arrived = len(base.driven.navigation())
    wait_for(lambda: len(base.driven.navigation()) > arrived + 10, what="navigation again")
    assert_only_the_guard_publishes(base)


def test_addresses_of_the_guard_and_the_driver_are_not_told(moving_base):
    base = moving_base
    inside = base.ros1
    assert inside.has("/driver", CMD_VEL_GUARD)
    for node in ("/driver", "/driver/", "//driver", "driver", CMD_VEL_GUARD, "/rtron_guard"):
        assert refused(inside, "lookupNode", "/rogue", node)
    assert ros_call(public(inside), "lookupNode", "/rogue", "/nav", timeout=LIMIT_S)
    found = ros_call(
        public(inside), "registerPublisher", "/spy", "/clock", "*", NOWHERE, timeout=LIMIT_S
    )
    assert found == []
    assert refused(inside, "registerSubscriber", "/spy", OUT, TYPE, "http://localhost:1/")
    assert refused(inside, "registerSubscriber", "/spy", "/rosout", "*", "http://localhost:1/")
    guard = inside.uri_of(CMD_VEL_GUARD)
    assert ros_call(guard, "getMasterUri", "/spy", timeout=LIMIT_S) == public(inside)


@pytest.mark.long
def test_an_impostor_waits_until_the_node_is_gone(base):
    nav = base.navigate()
    at = base.ros1.uri_of("/nav")
    impostor = base.ros1.node("rogue.py", "/nav", "1000", f"{CMD_VEL}:={FLOW1}")
    wait_for(lambda: REFUSED in impostor.log, what="the impostor's error")
    assert "is registered at another address" in base.ros1.master.log
    assert_only_navigation_arrives(base)
    assert base.ros1.uri_of("/nav") == at
    assert not nav.ended
    impostor.stop()
    nav.kill()
    sent = len(base.driven.navigation())
    base.navigate()
    wait_for(lambda: len(base.driven.navigation()) > sent, what="the new navigation")


@pytest.mark.long
def test_a_node_that_hangs_keeps_its_name(base):
    nav = base.navigate()
    nav.tell(signal.SIGSTOP)
    try:
        assert refused(base.ros1, "registerPublisher", "/nav", FLOW1, TYPE, "http://localhost:9/")
    finally:
        nav.tell(signal.SIGCONT)


def test_nobody_registers_at_the_address_of_a_planned_node_or_the_guard(moving_base):
    base = moving_base
    for node in ("/driver", "/nav", CMD_VEL_GUARD):
        port = base.ros1.uri_of(node).rstrip("/").rpartition(":")[2]
        for host in ("localhost", "127.0.0.1", "127.0.0.2"):
            wait_for(
                lambda uri=f"http://{host}:{port}/": refused(
                    base.ros1, "registerSubscriber", "/thief", "/chatter", "*", uri
                ),
                what="a refusal",
            )


def test_a_bundle_of_calls_is_no_way_around(moving_base):
    base = moving_base
    at = base.ros1.uri_of(CMD_VEL_GUARD)
    bundle = [
        {"methodName": "getPid", "params": ["/x"]},
        {"methodName": "registerPublisher", "params": ["/x", OUT, TYPE, "http://localhost:9/"]},
        {"methodName": "unregisterPublisher", "params": [CMD_VEL_GUARD, OUT, at]},
        {"methodName": "system.multicall", "params": [[]]},
        {"methodName": "getUri", "params": ["/x"]},
    ]
    answers = call(public(base.ros1), "system.multicall", bundle, timeout=LIMIT_S)
    assert [answer[0][0] for answer in answers] == [1, -1, -1, -1, 1]
    assert answers[4][0][2] == public(base.ros1) + "/"
    assert_only_the_guard_publishes(base)


@pytest.mark.long
def test_late_successors_hear_what_the_guard_lets_through(ros1):
    plan = plan_of(grcn(CMD_VEL, ["/nav"], ["/late", "/relay"]))
    inside = start(ros1, plan)
    start_guard(inside, plan, CMD_VEL_GUARD)
    say(inside, "nav", FLOW1, TYPE, TWIST % 7)
    inside.spawn("/usr/lib/topic_tools/relay", OUT, "/relayed", *named("/relay"))
    for name, topic in (("late", OUT), ("anybody", CMD_VEL), ("other", "/relayed")):
        heard = TopicEcho(inside, name, topic)
        assert heard.wait_for(len, "velocities")[0][0] == 7


def test_rospy_has_all_of_the_master(inside):
    done = inside.node("master_api_client.py", "/master_api_client")
    wait_for(lambda: done.ended, what="the client's end")
    assert "all done" in done.log
    assert done.code == 0, done.log
    wait_for(lambda: inside.state() == [{}, {}, {}], what="all to be unregistered")
    assert "refused" not in inside.master.log


def test_the_tools_of_ros_work(moving_base):
    base = moving_base
    ros1 = base.ros1
    assert {"/nav", "/driver", CMD_VEL_GUARD} <= set(ros1.run("rosnode", "list").split())
    assert " * /rtron/cmd_vel/flow1 [geometry_msgs/Twist]" in ros1.run("rosnode", "info", "/nav")
    assert "xmlrpc reply from" in ros1.run("rosnode", "ping", "-c", "1", "/nav")
    assert f" * {CMD_VEL_GUARD}" in ros1.run("rostopic", "info", CMD_VEL)
    assert ros1.run("rostopic", "echo", "-n", "2", CMD_VEL).count("linear:") == 2
    rates = ros1.spawn("rostopic", "hz", CMD_VEL)
    wait_for(lambda: "average rate: " in rates.log, what="rostopic hz")
    ros1.run("rosparam", "set", "/a/b", "[1, 2]")
    assert ros1.run("rosparam", "get", "/a/b").split() == ["-", "1", "-", "2"]
    assert "/a/b" in ros1.run("rosparam", "list").split()
    ros1.run("rosparam", "delete", "/a")
    assert "/a/b" not in ros1.run("rosparam", "list").split()
    said = ros1.run("rosnode", "info", "/driver")
    assert "/rtron/cmd_vel/out" in said


def test_roslaunch_starts_the_guarded_app_unchanged(inside, driver):
    launch = write_app(inside.folder, driver)
    plan, out = inside.folder / "rtron.yaml", inside.folder / "guarded" / "base.launch"
    plan.write_text(write_plan(drive_plan()))
    driven = Driven(inside.folder / "driven.txt")
    argument = f"out:={driven.path}"
    instrumented = inside.rtron("instrument", launch, argument, "--plan", plan, "-o", out)
    wait_for(lambda: instrumented.ended, what="rtron instrument")
    assert instrumented.code == 0, instrumented.log
    launched = inside.spawn("roslaunch", out, argument)
    wait_for(driven.navigation, what="navigation at the driver")
    flow = "/rtron/cmd_vel/flow2"
    before = inside.received(CMD_VEL_GUARD, flow)
    wait_for(lambda: inside.received(CMD_VEL_GUARD, flow) >= before + 500, what="the attack")
    assert driven.turns_after_navigation_began() == 0
    assert "refused" not in inside.master.log
    launched.stop()
    gone = {"/nav", "/driver", "/rogue", CMD_VEL_GUARD}
    wait_for(
        lambda: not gone & {n for side in inside.state() for ns in side.values() for n in ns},
        what="the app to leave the master",
    )


def private_pid(inside):
    return ros_call(inside.uri, "getPid", "/test", timeout=LIMIT_S)


@pytest.mark.long
def test_the_proxy_ends_with_an_error_when_the_master_does(base):
    base.navigate()
    os.kill(private_pid(base.ros1), signal.SIGKILL)
    proxy = base.ros1.master
    wait_for(lambda: proxy.ended, what="the end of the proxy")
    assert proxy.code == 2
    assert "rosmaster has ended" in proxy.log
    assert "Traceback" not in proxy.log
    with pytest.raises(RTronError):
        ros_call(public(base.ros1), "getPid", "/test", timeout=LIMIT_S)
    rogue = base.ros1.node("rogue.py", "/by_hand", "1000", f"{CMD_VEL}:={OUT}")
    wait_for(lambda: rogue.log, what="the rogue's complaint")
    count = len(base.driven.navigation()) + 10
    wait_for(lambda: len(base.driven.navigation()) >= count, what="a second of navigation")
    assert base.driven.turns() == 0


@pytest.mark.long
def test_a_master_that_hangs_is_answered_for_and_works_again(inside):
    pid = private_pid(inside)
    os.kill(pid, signal.SIGSTOP)
    try:
        said = call(public(inside), "getPid", "/test", timeout=LIMIT_S)
        assert said == [-1, "the master behind the proxy does not answer", -1]
        assert refused(inside, "lookupNode", "/test", "/driver")
    finally:
        os.kill(pid, signal.SIGCONT)
    assert ros_call(public(inside), "getPid", "/test", timeout=LIMIT_S) == pid


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_master_ends_with_the_proxy(inside, number):
    proxy = inside.master
    os.kill(proxy.pid, number)
    wait_for(lambda: proxy.ended, what="the end of the proxy")
    if number != signal.SIGKILL:
        assert proxy.code == 0, proxy.log
    wait_for(lambda: inside.ask(inside.uri, "getPid") is None, what="the end of rosmaster")
    assert "Traceback" not in proxy.log


def test_a_port_that_is_taken_is_an_error(inside):
    port = public(inside).rpartition(":")[2]
    second = inside.rtron("master", "--plan", inside.folder / "proxy.yaml", "--port", port)
    wait_for(lambda: second.ended, what="the second proxy's end")
    assert second.code == 2
    assert f"port {port}: Address already in use" in second.log


def test_the_private_master_listens_on_loopback_only(inside):
    port = int(inside.uri.rstrip("/").rpartition(":")[2])
    rows = [line.split() for line in Path("/proc/net/tcp").read_text().splitlines()[1:]]
    at = {row[1] for row in rows if row[3] == "0A" and int(row[1].partition(":")[2], 16) == port}
    assert at == {f"0100007F:{port:04X}"}


def test_a_scan_sees_behind_the_proxy(base):
    base.navigate()
    words = ("scan", "--live", "--format", "graph", "--fail-on", "never")
    graph = json.loads(base.ros1.run(sys.executable, "-m", "rtron", *words))
    assert graph["unresolved"] == []
    assert {"/nav", "/driver", CMD_VEL_GUARD} <= {node["name"] for node in graph["nodes"]}
    assert "refused" not in base.ros1.master.log
