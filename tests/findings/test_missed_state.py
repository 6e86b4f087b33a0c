"""Which topics tell a state, whose publishers count, and which readers lose it."""

from dataclasses import replace

import pytest
from finding_graphs import found, small_graph, the_finding, with_qos
from finding_pairs import BEST_EFFORT, LATCHED, RELIABLE, STOP, latched_state

from rtron.vocabulary import Action, ActionRole, Certainty, FindingLevel, ServiceClient, Severity

RULE = "missed_state"
MAP = """
/map_server nav2_map_server own
    pub /map nav_msgs/msg/OccupancyGrid
/explore explore own
    sub /map nav_msgs/msg/OccupancyGrid
"""


def map_app(executable, type="nav_msgs/msg/OccupancyGrid"):
    graph = with_qos(
        small_graph(MAP.replace("nav_msgs/msg/OccupancyGrid", type)), LATCHED, RELIABLE
    )
    server, *others = sorted(graph.nodes, key=lambda node: node.name != "/map_server")
    return replace(graph, nodes=(replace(server, executable=executable), *others))


class TestMissedState:
    def test_it_names_both_ends(self):
        finding = the_finding(RULE, latched_state(RELIABLE))
        assert finding.summary == (
            "/pad loses the state on /hardware/stop_state if it starts later than it is sent"
        )
        assert finding.cause.startswith("/board latches it and sends it only when it changes")
        assert (finding.certainty, finding.severity) == (Certainty.LIKELY, Severity.MEDIUM)
        assert finding.nodes == ("/board", "/pad")

    def test_several_readers_are_one_finding(self):
        more = "/arm arm own\n    sub /hardware/stop_state std_msgs/msg/Bool\n"
        finding = the_finding(RULE, latched_state(BEST_EFFORT, STOP + more))
        assert finding.summary.startswith("/arm and /pad lose the state")
        assert "if they start later" in finding.summary

    @pytest.mark.parametrize("name", ["/estop", "/arm/mode", "/gait_state", "/zones/active"])
    def test_words_of_the_last_name_tell_a_state(self, name):
        text = STOP.replace("/hardware/stop_state", name)
        assert found(RULE, latched_state(RELIABLE, text, name))

    @pytest.mark.parametrize(
        "name", ["/robot_description", "/statement", "/plan", "/route", "/mission", "/goal"]
    )
    def test_others_decide_nothing(self, name):
        text = STOP.replace("/hardware/stop_state", name)
        assert not found(RULE, latched_state(RELIABLE, text, name))

    @pytest.mark.parametrize(
        ("more", "level"),
        [
            ("", "pedantic"),
            ("    pub /cmd geometry_msgs/msg/Twist\n", "regular"),
            ("    sub /cmd_vel geometry_msgs/msg/Twist\n", "regular"),
            ("    sub /estop std_msgs/msg/Bool\n", "pedantic"),
        ],
    )
    def test_who_only_looks_at_it_is_for_the_pedantic(self, more, level):
        assert the_finding(RULE, latched_state(RELIABLE, STOP + more)).level == level

    def test_who_calls_something_acts(self):
        graph = latched_state(RELIABLE)
        client = ServiceClient(node="/pad", name="/go")
        goals = Action(node="/pad", name="/go", role=ActionRole.CLIENT)
        for acting in ({"clients": (client,)}, {"actions": (goals,)}):
            assert the_finding(RULE, replace(graph, **acting)).level is FindingLevel.REGULAR
        for idle in (
            {"clients": (replace(client, implicit=True),)},
            {"actions": (replace(goals, role=ActionRole.SERVER),)},
        ):
            assert the_finding(RULE, replace(graph, **idle)).level is FindingLevel.PEDANTIC

    @pytest.mark.parametrize("qos", [LATCHED, None])
    def test_a_reader_whose_request_is_another_or_not_known(self, qos):
        assert not found(RULE, latched_state(qos))

    def test_a_reader_that_asks_twice_gets_it(self):
        graph = latched_state(RELIABLE)
        (late,) = graph.subscribers("/hardware/stop_state")
        graph = replace(graph, endpoints=(*graph.endpoints, replace(late, qos=LATCHED)))
        assert not found(RULE, graph)

    @pytest.mark.parametrize("package", ["rviz2", "rosbag2"])
    def test_who_only_shows_or_records_decides_nothing(self, package):
        assert not found(RULE, latched_state(RELIABLE, STOP.replace("/pad pad", f"/pad {package}")))

    def test_another_publisher_may_repeat_it(self):
        more = "/echo echo own\n    pub /hardware/stop_state std_msgs/msg/Bool\n"
        assert not found(RULE, latched_state(RELIABLE, STOP + more))

    def test_a_publisher_that_is_not_known_to_be_seldom(self):
        assert not found(RULE, replace(latched_state(RELIABLE), wiring=()))

    def test_ros_1_sends_what_is_latched_to_all(self):
        assert not found(RULE, replace(latched_state(RELIABLE), ros=1))

    @pytest.mark.parametrize("executable", ["map_server", "nav2_map_server::MapServer"])
    def test_the_map_server_sends_its_map_once(self, executable):
        finding = the_finding(RULE, map_app(executable))
        assert finding.summary.startswith("/explore loses the state on /map")

    def test_other_servers_may_send_theirs_again(self):
        assert not found(RULE, map_app("vector_object_server"))
        assert not found(RULE, map_app("map_server", "my_msgs/msg/Map"))
