"""The graph of an app that runs: a real master, nodes of rospy and roscpp, and strangers."""

import time
from contextlib import ExitStack
from itertools import chain, repeat
from xmlrpc.client import Fault, dumps

import pytest
from faulty_nodes import garbage, never_answer, saying, stranger
from file_tree import write
from harness import LIMIT_S, NODES, ROS_PYTHON, Ros1, free_port, named, wait_for
from roslaunch_oracle import package

from rtron.errors import SourceError
from rtron.sources.live.ros1.source import Ros1LiveSource
from rtron.vocabulary import Action, ActionRole, Direction, Resolution
from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = pytest.mark.ros1
TIMEOUT_S = 2.0
MOST_OF_ONE = 15
"""What 150 silent nodes may cost, beside one: they would cost 150 times as much one by one."""
HONEST_S = 15.0
"""Time for nodes that do answer: a busy machine is not a silent node."""


def read(ros1, timeout=HONEST_S):
    return Ros1LiveSource(ros1.uri, timeout).read()


def join(ros1, name, *ends):
    """Start a node of these ends and wait until the master knows all of them."""
    node = ros1.node("string_endpoints.py", name, *ends)
    wait_for(lambda: "ready" in node.log, what=f"the ends of {name}")
    return node


def ends(graph, node):
    """Return what a node publishes and subscribes, as `>/topic` and `</topic`, but for its log."""
    marks = {Direction.PUBLISH: ">", Direction.SUBSCRIBE: "<"}
    return {marks[e.direction] + e.topic for e in graph.endpoints if e.node == node} - {">/rosout"}


def unresolved(graph):
    return {each.what: each.why for each in graph.unresolved}


def register(ros1, node, uri):
    """Tell the master of a publisher, as a node of that name and address would."""
    params = (node, "/chatter", "std_msgs/String", uri)
    ros_call(ros1.uri, "registerPublisher", *params, timeout=LIMIT_S)


def test_a_running_app_is_read(ros1):
    app = write(ros1.folder, {"talk/package.xml": package("talk")})
    script = app / "talk" / "scripts" / "string_endpoints.py"
    script.parent.mkdir()
    script.write_text((NODES / "string_endpoints.py").read_text())
    ros1.spawn(ROS_PYTHON, script, ">/chatter", *named("/robot/talker"))
    join(ros1, "/listener", "</relayed", "</chatter")
    ros1.spawn("/usr/lib/topic_tools/relay", "/chatter", "/relayed", "__name:=relay")
    ros1.wait_for_nodes("/robot/talker", "/listener", "/relay")
    wait_for(lambda: ros1.connected("/robot/talker", "/relay", "/chatter"), what="the relay")
    graph = read(ros1)

    assert ends(graph, "/robot/talker") == {">/chatter"}
    assert ends(graph, "/listener") == {"</relayed", "</chatter"}
    assert {"</chatter"} <= ends(graph, "/relay")
    assert graph.unresolved == ()
    assert graph.ros == 1
    (spoken,) = graph.publishers("/chatter")
    assert (spoken.type, spoken.implicit) == ("std_msgs/String", False)
    assert spoken.resolution is Resolution.OBSERVED
    assert spoken.evidence[0].file == ros1.uri_of("/robot/talker")
    assert {e.node for e in graph.publishers("/rosout") if e.implicit} == {
        "/robot/talker",
        "/listener",
        "/relay",
    }
    programs = {node.name: (node.package, node.executable) for node in graph.nodes}
    assert programs["/robot/talker"] == ("talk", "string_endpoints.py")
    assert programs["/relay"] == ("topic_tools", "relay")
    services = {service.name: (service.node, service.type) for service in graph.services}
    assert services["/relay/get_loggers"] == ("/relay", "roscpp/GetLoggers")
    assert services["/listener/set_logger_level"] == ("/listener", "roscpp/SetLoggerLevel")


def test_the_five_topics_of_an_action_are_one_action(ros1):
    up, down = ("goal", "cancel"), ("status", "feedback", "result")
    client = [f">/arm/{part}" for part in up] + [f"</arm/{part}" for part in down]
    server = [f"</arm/{part}" for part in up] + [f">/arm/{part}" for part in down]
    join(ros1, "/client", *client, ">/gripper/goal")
    join(ros1, "/server", *server)
    assert set(read(ros1).actions) == {
        Action(node="/client", name="/arm", role=ActionRole.CLIENT),
        Action(node="/server", name="/arm", role=ActionRole.SERVER),
    }


def test_a_dead_node_is_unresolved_and_stays_in_the_graph(ros1):
    join(ros1, "/alive", ">/chatter")
    join(ros1, "/dead", ">/chatter").kill()
    graph = read(ros1)
    assert ends(graph, "/dead") == {">/chatter"}
    assert set(unresolved(graph)) == {"/dead"}
    assert "refused" in unresolved(graph)["/dead"]


def test_strangers_do_not_cost_the_graph(ros1):
    def answer(value):
        return saying(dumps(((1, "", value),), methodresponse=True).encode())

    rows = [[1, "/x", "i", "TCPROS", "/t", True], [2, 3, 4]]
    answers = {
        "/silent": never_answer,
        "/garbage": garbage,
        "/shapeless": answer({"bus": "info"}),
        "/half_a_row": answer(rows),
        "/numbers": answer([[1, 2, 3, 4, 5]]),
        "/no_pid": answer([]),
        "/no_xml": saying(b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>"),
        "/long_fault": saying(dumps(Fault(1, "x" * 100_000)).encode()),
        "/no_triple": saying(dumps((7,), methodresponse=True).encode()),
    }
    join(ros1, "/honest", ">/chatter")
    with ExitStack() as stack:
        for node, behaviour in answers.items():
            register(ros1, node, stack.enter_context(stranger(behaviour)))
        register(ros1, "/nowhere", "rosrpc://here:1")
        graph = read(ros1)
    assert set(unresolved(graph)) == {*answers, "/nowhere"}
    assert max(map(len, unresolved(graph).values())) < 1000
    assert {e.node for e in graph.publishers("/chatter")} == {"/honest", *answers, "/nowhere"}


def test_many_silent_nodes_do_not_add_up(ros1):
    with stranger(never_answer) as uri:
        nodes = [f"/silent{n}" for n in range(150)]
        register(ros1, nodes[0], uri)
        began = time.monotonic()
        read(ros1, TIMEOUT_S)
        one = time.monotonic() - began
        for node in nodes[1:]:
            register(ros1, node, uri)
        began = time.monotonic()
        graph = read(ros1, TIMEOUT_S)
        took = time.monotonic() - began
    assert took < MOST_OF_ONE * one
    assert set(unresolved(graph)) == set(nodes)


def test_a_node_that_claims_another_process_does_not_get_its_package(ros1):
    relay = ros1.spawn("/usr/lib/topic_tools/relay", "/other", "/relayed", "__name:=relay")
    ros1.wait_for_nodes("/relay")
    claim = saying(dumps(((1, "", relay.pid),), methodresponse=True).encode())
    bus = saying(dumps(((1, "", []),), methodresponse=True).encode())
    answers = chain([bus], repeat(claim))

    def in_turn(connection):
        next(answers)(connection)

    with stranger(in_turn) as uri:
        register(ros1, "/liar", uri)
        graph = read(ros1)
    assert {n.name: n.package for n in graph.nodes} == {"/liar": "", "/relay": "topic_tools"}
    assert graph.unresolved == ()


def test_a_publisher_that_only_the_subscriber_knows_is_told(ros1, tmp_path_factory):
    join(ros1, "/talker", ">/chatter")
    join(ros1, "/listener", "</chatter")
    wait_for(lambda: ros1.connected("/talker", "/listener", "/chatter"), what="the talker")
    assert read(ros1).unresolved == ()
    with Ros1(tmp_path_factory.mktemp("elsewhere")) as elsewhere:
        join(elsewhere, "/ghost", ">/chatter")
        ghost = elsewhere.uri_of("/ghost")
        publishers = [ros1.uri_of("/talker"), ghost]
        ros1.ask(ros1.uri_of("/listener"), "publisherUpdate", "/chatter", publishers)
        wait_for(lambda: elsewhere.connected("/ghost", "/listener", "/chatter"), what="the ghost")
        graph = read(ros1)
    assert unresolved(graph) == {
        "/listener": f"takes messages on /chatter from {ghost}, which the master does not know"
    }


def test_without_a_master_there_is_help():
    with pytest.raises(SourceError, match="no app can be read at http://localhost:") as raised:
        Ros1LiveSource(f"http://localhost:{free_port()}", TIMEOUT_S).read()
    assert "--master" in raised.value.help


@pytest.mark.parametrize(
    "answer", [never_answer, garbage, saying(dumps(((1, "", 5),), methodresponse=True).encode())]
)
def test_a_master_that_is_none_is_told(answer):
    with stranger(answer) as uri, pytest.raises(SourceError, match="no app can be read"):
        Ros1LiveSource(uri, TIMEOUT_S).read()


def test_malformed_entries_of_the_system_state_are_counted():
    rows = [["/good", ["/node", 7]], ["/bad", "/node"], "/worse", [1, []]]
    state = saying(dumps(((1, "", [rows, [], []]),), methodresponse=True).encode())
    with stranger(state) as uri:
        graph = Ros1LiveSource(uri, TIMEOUT_S).read()
    assert [(e.node, e.topic) for e in graph.endpoints] == [("/node", "/good")]
    assert unresolved(graph)["the master's system state"].startswith("has 4 malformed")
