"""Which kind of source a publisher of commands is, by what it reads, serves and carries."""

from dataclasses import replace

import pytest
from notation import graph_of

from rtron.planning.app_topics import action_servers
from rtron.planning.command_sources import CommandSources, SourceKind
from rtron.vocabulary import FunctionType, Trust, WiringFact, WiringFactKind

TWIST = "geometry_msgs/Twist"
SCRIPT = f"/script own_pkg own\n pub /raw {TWIST}\n"
JOYSTICK = f"/stick own_pkg own\n sub /joy sensor_msgs/Joy\n pub /raw {TWIST}\n"
SMOOTHER = f"/smooth own_pkg third_party\n sub /raw {TWIST}\n pub /cmd_vel {TWIST}\n"
NAVIGATION = f"/nav own_pkg own\n server /drive p/Drive\n pub /raw {TWIST}\n"
BASE = f"/base driver own\n sub /cmd_vel {TWIST}\n"


def sources(text: str) -> CommandSources:
    graph = graph_of("app", text)
    return CommandSources(graph, action_servers(graph))


@pytest.mark.parametrize(
    ("node", "kind"),
    [
        ("/a own_pkg third_party\n sub /joy sensor_msgs/Joy", SourceKind.PERSON),
        ("/a teleop_twist_keyboard third_party", SourceKind.PERSON),
        ("/a rosbridge_server third_party", SourceKind.NETWORK),
        ("/a own_pkg third_party\n server /drive p/Drive", SourceKind.AUTONOMY),
        ("/a own_pkg own\n sub /scan sensor_msgs/LaserScan", SourceKind.AUTONOMY),
        ("/a own_pkg own", SourceKind.SCRIPT),
        ("/estop own_pkg own", SourceKind.EMERGENCY_STOP),
        ("/estop own_pkg third_party", SourceKind.SCRIPT),
    ],
)
def test_what_a_node_reads_and_serves_tells_its_kind(node, kind):
    name, found = node.split()[0], sources(f"{node}\n pub /cmd_vel {TWIST}\n{BASE}")
    assert found.kind(name) is kind


@pytest.mark.parametrize(
    ("carried", "kind"),
    [
        ("", SourceKind.STAGE),
        (JOYSTICK, SourceKind.PERSON),
        (NAVIGATION, SourceKind.STAGE),
        (SCRIPT, SourceKind.SCRIPT),
        (JOYSTICK + NAVIGATION, SourceKind.STAGE),
    ],
)
def test_a_stage_is_what_it_carries(carried, kind):
    assert sources(carried + SMOOTHER + BASE).kind("/smooth") is kind


def test_stages_that_feed_each_other_in_a_ring_come_to_an_end():
    ring = (("/first", "/raw"), ("/raw", "/second"), ("/second", "/first"))
    stages = "".join(
        f"/stage{n} own_pkg own\n sub {heard} {TWIST}\n pub {sent} {TWIST}\n"
        for n, (heard, sent) in enumerate(ring)
    )
    assert sources(stages + JOYSTICK + SMOOTHER).kind("/smooth") is SourceKind.PERSON


def test_the_velocity_that_the_base_measures_makes_no_stage():
    base = BASE + f" pub /wheels {TWIST}\n"
    reacts = f"/reacts own_pkg own\n sub /wheels {TWIST}\n pub /cmd_vel {TWIST}\n"
    assert sources(base + reacts).kind("/reacts") is SourceKind.AUTONOMY


@pytest.mark.parametrize(
    ("how", "kind"), [("web server", SourceKind.PERSON), ("MQTT", SourceKind.NETWORK)]
)
def test_a_page_is_for_persons_and_another_socket_for_a_network(how, kind):
    found = sources(SCRIPT)
    fact = WiringFact(kind=WiringFactKind.SOCKET, subject="/script", value=how)
    assert replace(found, graph=replace(found.graph, wiring=(fact,))).kind("/script") is kind


def test_persons_go_before_stages_and_these_before_autonomy_whatever_they_are_called():
    texts = (
        f"/a_script x own\n pub /cmd_vel {TWIST}\n",
        f"/b_docks x own\n server /dock p/Dock\n pub /cmd_vel {TWIST}\n",
        SMOOTHER,
        f"/z_stick x third_party\n sub /joy sensor_msgs/Joy\n pub /cmd_vel {TWIST}\n",
        f"/z_estop x own\n pub /cmd_vel {TWIST}\n",
        f"/a_web rosbridge_server third_party\n pub /cmd_vel {TWIST}\n",
        NAVIGATION,
        BASE,
    )
    found = sources("".join(texts))
    names = ["/a_script", "/a_web", "/b_docks", "/smooth", "/z_estop", "/z_stick"]
    order = ["/z_estop", "/z_stick", "/smooth", "/b_docks", "/a_script", "/a_web"]
    assert found.sort(names) == order
    assert not list(found.unordered(names))


def test_the_function_of_a_stranger_raises_nothing():
    graph = graph_of("app", SCRIPT.replace("own\n", "third_party\n"))
    (node,) = graph.nodes
    for trust, kind in ((Trust.OWN, SourceKind.PERSON), (Trust.THIRD_PARTY, SourceKind.SCRIPT)):
        known = replace(node, function=FunctionType.TELEOPERATION, trust=trust)
        assert CommandSources(replace(graph, nodes=(known,)), ()).kind("/script") is kind
