"""No endpoint of a generated Python program is lost without a note, and none is made up."""

import re
import sys

import pytest
from harness import ROS_PYTHON, wait_for
from python_oracle import faults, found_by_name, scan
from python_programs import RCLPY, ROSPY, make_program, single_programs

LIBRARIES = {"rospy": ROSPY, "rclpy": RCLPY}
SHARE_BY_NAME = 0.85
SHOWN = 3
SAMPLE = range(12)


def described(seed, program, fault):
    """Return a fault with its lines, and the seed that makes it again."""
    what, end = fault
    first, last = getattr(end, "lines", (1, 0))
    text = "\n".join(program.text.splitlines()[first - 1 : last])
    return f"seed {seed}: {what} {getattr(end, 'name', end)}\n{text}"


@pytest.mark.parametrize("library", LIBRARIES.values(), ids=LIBRARIES)
def test_no_endpoint_is_lost_or_made_up(library, seeds, tmp_path):
    found, known, total = [], 0, 0
    for seed in seeds:
        program = make_program(library, seed)
        interface = scan(program, library.ros, tmp_path)
        found += [described(seed, program, fault) for fault in faults(program, interface)]
        by_name, living = found_by_name(program, interface)
        known, total = known + by_name, total + living
    print(f"{len(seeds)} programs, {total} endpoints, {known} of them found by name")
    assert found[:SHOWN] == []
    assert known >= SHARE_BY_NAME * total


@pytest.mark.parametrize("library", LIBRARIES.values(), ids=LIBRARIES)
def test_each_construct_alone_is_followed_or_noted(library, tmp_path):
    found = []
    for number, program in enumerate(single_programs(library)):
        interface = scan(program, library.ros, tmp_path)
        found += [described(number, program, fault) for fault in faults(program, interface)]
    assert found == []


def test_a_seed_makes_the_same_program_again():
    assert make_program(ROSPY, "1/0") == make_program(ROSPY, "1/0")
    assert make_program(ROSPY, "1/0") != make_program(ROSPY, "1/1")


ACTION_ENDS = {"goal": "action_client", "cancel": "action_client"}
ACTION_ENDS |= dict.fromkeys(("status", "feedback", "result"), "action_server")


def rospy_endpoints(ros1):
    """Return what the master knows of the node, action topics as actions, without service calls."""
    publishers, subscribers, services = ros1.state()
    found = set()
    for kind, names in (("publish", publishers), ("subscribe", subscribers)):
        for name in (name for name, nodes in names.items() if "/n" in nodes):
            base, _, end = name.strip("/").rpartition("/")
            if base and kind == "publish":
                found.add((ACTION_ENDS[end], base))
            elif not base and end not in {"rosout", "clock"}:
                found.add((kind, end))
    own = (name.strip("/") for name in services)
    return found | {("service", name) for name in own if not name.startswith("n/")}


def expected(program, *without):
    return {(e.kind, e.name) for e in program.endpoints if e.lives and e.kind not in without}


@pytest.mark.ros1
@pytest.mark.long
@pytest.mark.parametrize("number", SAMPLE)
def test_a_program_for_rospy_has_what_it_is_made_of(number, ros1, tmp_path):
    program = make_program(ROSPY, f"run/{number}")
    script = tmp_path / "program.py"
    script.write_text(program.text)
    process = ros1.spawn(ROS_PYTHON, script)
    wait_for(lambda: "READY" in process.log or process.ended, what="the program")
    assert not process.ended, process.log
    wanted = expected(program, "service_client")
    wait_for(lambda: rospy_endpoints(ros1) >= wanted, what=f"{wanted}")
    assert rospy_endpoints(ros1) == wanted


def rclpy_endpoints(watcher):
    """Return what nodes of the domain have, without what every node has."""
    found = set()
    for node in watcher.get_node_names_and_namespaces():
        for kind, ask in (
            ("publish", watcher.get_publisher_names_and_types_by_node),
            ("subscribe", watcher.get_subscriber_names_and_types_by_node),
            ("service", watcher.get_service_names_and_types_by_node),
            ("service_client", watcher.get_client_names_and_types_by_node),
        ):
            names = [name for name, _ in ask(*node)] if node[0] != "watcher" else []
            found.update(filter(None, (_rclpy_endpoint(kind, name) for name in names)))
    return found


def _rclpy_endpoint(kind, name):
    """Return an endpoint of the program; an action's is that of its goal service."""
    base, _, hidden = name.strip("/").partition("/_action/")
    if hidden:
        actions = {"service": "action_server", "service_client": "action_client"}
        return (actions[kind], base) if hidden == "send_goal" else None
    is_own = re.fullmatch(r"t\d{3}_\w+|wrong", base) is not None
    return (kind, base) if is_own else None


@pytest.mark.ros2
@pytest.mark.long
@pytest.mark.parametrize("number", SAMPLE)
def test_a_program_for_rclpy_has_what_it_is_made_of(number, ros2, tmp_path):
    rclpy = pytest.importorskip("rclpy")
    program = make_program(RCLPY, f"run/{number}")
    script = tmp_path / "program.py"
    script.write_text(program.text)
    process = ros2.spawn(sys.executable, script)
    wait_for(lambda: "READY" in process.log or process.ended, what="the program")
    assert not process.ended, process.log
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=ros2.domain)
    watcher = rclpy.create_node("watcher", context=context)
    wanted = expected(program)
    try:
        wait_for(lambda: rclpy_endpoints(watcher) >= wanted, what=f"{wanted}")
        assert rclpy_endpoints(watcher) == wanted
    finally:
        watcher.destroy_node()
        rclpy.shutdown(context=context)
