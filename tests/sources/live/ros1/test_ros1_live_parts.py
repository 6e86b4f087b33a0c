"""The parts of reading a running ROS 1 app that need no ROS."""

import os
import subprocess
import sys
import threading
from contextlib import contextmanager, suppress

import pytest
from faulty_nodes import never_answer, stranger
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import RTronError, SourceError, WireError
from rtron.sources.live.ros1.actions import find_actions
from rtron.sources.live.ros1.queries import (
    NodeProgram,
    NodeReplies,
    find_program,
    query_service_type,
    run_with_deadline,
)
from rtron.sources.live.ros1.source import ghost_publishers, unlisted_connections
from rtron.vocabulary import Action, ActionRole, Direction, Endpoint
from rtron.wire.ros1 import ros_api
from rtron.wire.ros1.tcpros import encode_header

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=3) | st.sampled_from("io"),
    lambda inner: st.lists(inner, max_size=7) | st.dictionaries(st.text(max_size=2), inner),
)
READERS = {
    ros_api.parse_system_state: ros_api.SystemState,
    ros_api.parse_topic_types: dict,
    ros_api.parse_bus_info: tuple,
    ros_api.parse_process_id: int,
    ros_api.parse_text: str,
}


@given(VALUES | st.tuples(VALUES, VALUES, VALUES).map(list))
def test_any_answer_is_read_or_refused(value):
    for read, type in READERS.items():
        with suppress(WireError):
            assert isinstance(read(value), type)


def test_a_connection_that_has_ended_brings_nothing():
    rows = [
        [1, "http://a:1/", "i", "TCPROS", "/t", False, "closed"],
        [2, "http://b:2/", "i", "TCPROS", "/t", True, "open"],
        [3, "http://c:3/", "i", "TCPROS", "/t"],
        [4, "/d", "o", "TCPROS", "/t", True],
    ]
    sources = [link.source for link in ros_api.parse_bus_info(rows, connected_only=True)]
    assert sources == ["http://b:2/", "http://c:3/"]


def test_a_publisher_that_joined_meanwhile_is_no_ghost():
    link = ros_api.BusConnection("/t", "http://new:1/")
    found = unlisted_connections({"/n": NodeReplies("http://n:1/", (link, link))}, [("/t", "/old")])
    assert [suspect.connection for suspect in found] == [link]
    assert not list(ghost_publishers(found, [("/t", "/new")], {"/new": "http://NEW:1"}))
    (ghost,) = ghost_publishers(found, [("/t", "/new")], {"/new": "http://else:1"})
    assert (ghost.what, ghost.evidence[0].file) == ("/n", "http://new:1/")


def test_who_publishes_another_topic_may_still_be_a_ghost_on_this_one():
    link = ros_api.BusConnection("/t", "http://p:1/")
    nodes = {"/n": NodeReplies("http://n:1/", (link,)), "/p": NodeReplies("http://p:1/")}
    assert unlisted_connections(nodes, [("/other", "/p")])
    assert not unlisted_connections(nodes, [("/t", "/p")])


def test_a_job_that_hangs_delays_nobody_for_longer_than_the_limit():
    forever = threading.Event()
    jobs = {"quick": lambda: 1, "hangs": forever.wait}
    assert run_with_deadline(jobs, 2) == {"quick": 1}
    forever.set()


def test_no_jobs_take_no_time():
    assert run_with_deadline({}, 60) == {}


def answering(data):
    def answer(connection):
        connection.recv(1 << 16)
        connection.sendall(data)
        connection.close()

    return answer


def probe(answer):
    with stranger(answer) as uri:
        return query_service_type(uri.replace("http:", "rosrpc:"), "/s", "/scan", 0.3)


def test_a_service_tells_its_type():
    assert probe(answering(encode_header({"type": "std_srvs/Empty"}))) == "std_srvs/Empty"


@pytest.mark.parametrize(
    "answer",
    [
        never_answer,
        answering(b""),
        answering(b"\xff\xff\xff\xff"),
        answering(b"\x08\x00\x00\x00\xff\xff\xff\xff0000"),
        answering(encode_header({"error": "no such service"})),
    ],
)
def test_a_service_that_does_not_is_an_error(answer):
    with pytest.raises(RTronError):
        probe(answer)


def test_nobody_at_a_service_is_an_error():
    with pytest.raises(SourceError):
        query_service_type("rosrpc://localhost:1", "/s", "/scan", 0.3)
    with pytest.raises(WireError):
        query_service_type("http://localhost:1", "/s", "/scan", 0.3)


def test_four_topics_are_no_action():
    def end(topic, direction=Direction.PUBLISH):
        return Endpoint(node="/n", topic=topic, direction=direction, type="p/LiftActionGoal")

    parts = ["goal", "cancel", "status", "feedback"]
    topics = [end(f"/lift/{part}") for part in parts]
    assert find_actions(topics) == ()
    whole = find_actions([*topics, end("/lift/result", Direction.SUBSCRIBE)])
    client = Action(node="/n", name="/lift", type="p/LiftAction", role=ActionRole.CLIENT)
    assert whole == (client,)


def test_a_process_that_does_not_listen_there_is_not_the_node():
    with stranger(never_answer) as uri:
        assert find_program(uri, 1) == NodeProgram()
        assert find_program(uri, 2**31) == NodeProgram()
        assert find_program(uri.replace("localhost", "192.0.2.1"), os.getpid()) == NodeProgram()


LISTEN = "import socket; s = socket.create_server(('', 0)); print(s.getsockname()[1]); input()"


@contextmanager
def listening(*arguments, cwd):
    """Run a Python that listens on a port; yields its process id and address."""
    words = [sys.executable, "-u", *arguments]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(words, cwd=cwd, text=True, **pipes) as process:
        yield process.pid, f"http://localhost:{process.stdout.readline().strip()}/"
        process.stdin.write("\n")
        process.stdin.flush()


def test_a_script_is_known_by_where_it_lies(tmp_path):
    places = {
        "lib/arm_driver/drive": ("arm_driver", "drive"),
        "src/arm/scripts/lift.py": ("arm_package", "lift.py"),
        "loose.py": ("", "loose.py"),
    }
    (tmp_path / "src" / "arm").mkdir(parents=True)
    manifest = "<package><name>arm_package</name></package>"
    (tmp_path / "src" / "arm" / "package.xml").write_text(manifest)
    for place, program in places.items():
        script = tmp_path / place
        script.parent.mkdir(parents=True, exist_ok=True)
        script.write_text(LISTEN)
        with listening(place, cwd=tmp_path) as (pid, uri):
            assert find_program(uri, pid) == NodeProgram(*program)


def test_a_text_or_a_module_that_runs_is_no_script(tmp_path):
    (tmp_path / "module.py").write_text(LISTEN)
    for arguments in (["-c", LISTEN], ["-m", "module"]):
        with listening(*arguments, cwd=tmp_path) as (pid, uri):
            assert find_program(uri, pid) == NodeProgram()
