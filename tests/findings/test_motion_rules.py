"""What the rules on motion count, what they leave out, and their words."""

from dataclasses import replace

import pytest
from finding_graphs import (
    BASE,
    FIRMWARE,
    MUX,
    STAMPED,
    TWIST,
    TWO_DRIVERS,
    found,
    parameters,
    small_graph,
    the_finding,
)
from finding_pairs import GOALS

from rtron.vocabulary import (
    Certainty,
    Direction,
    Endpoint,
    Evidence,
    FindingLevel,
    NodeParameter,
    Resolution,
    Service,
    ServiceClient,
    Severity,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.enums import HiddenPart

MUX_PASSED_BY = MUX + f"/teleop teleop own\n    pub /cmd_vel {TWIST}\n"
REMEDY = "put one arbiter before /cmd_vel: `rtron plan` proposes a guard (GRCN)"


RADIO = f"/radio radio own\n    sub /channels x/msg/Channels\n    pub /cmd_vel {TWIST}\n"

SHOWING = RADIO + "    pub /shown std_msgs/msg/Float64\n"


def wiring_of(kind, value, node="/base"):
    place = Evidence(file=f"{node}.cpp", line=3)
    return WiringFact(kind=WiringFactKind(kind), subject=node, value=value, evidence=(place,))


def relaying(relay, *facts):
    """Return the graph of a relay before a base, with what its source says of last messages."""
    type = next((line.split()[2] for line in relay.split("\n") if "sub /channels" in line), TWIST)
    link = f"/link link own\n    pub /channels {type}\n"
    flow = wiring_of("message_flow", "", "/radio")
    flow = replace(flow, evidence=flow.evidence * 2)
    graph = small_graph(link + relay + BASE, unread=("/firmware",), wiring=(*facts, flow))
    places = {fact.subject: fact.evidence for fact in facts}
    ends = tuple(replace(e, evidence=places.get(e.node, ())) for e in graph.endpoints)
    return replace(graph, endpoints=ends)


class TestSeveralPublishers:
    def test_with_a_known_reader(self):
        finding = the_finding("several_publishers", small_graph(TWO_DRIVERS + BASE))
        assert finding.summary == "/move_base and /teleop both drive the robot on /cmd_vel"
        assert finding.cause == (
            "no arbiter stands between them: /base obeys whoever published last"
        )
        assert finding.remedy == REMEDY
        assert finding.nodes == ("/move_base", "/teleop", "/base")
        assert finding.topics == ("/cmd_vel",)

    def test_with_a_reader_that_may_be_a_node_that_was_not_read(self):
        graph = small_graph(TWO_DRIVERS + FIRMWARE, unread=("/firmware",))
        finding = the_finding("several_publishers", graph)
        assert finding.cause == (
            "no arbiter stands between them: the base obeys whoever published last; its reader is "
            "not in the source, it may be /firmware (not read)"
        )
        assert finding.nodes == ("/move_base", "/teleop")

    def test_without_any_reader(self):
        finding = the_finding("several_publishers", small_graph(TWO_DRIVERS))
        assert finding.cause.endswith("published last; its reader is not in the source")

    def test_with_several_readers(self):
        text = TWO_DRIVERS + BASE + BASE.replace("/base", "/wheels")
        finding = the_finding("several_publishers", small_graph(text))
        assert finding.cause.endswith("/base and /wheels obey whoever published last")

    def test_an_arbiter_is_passed_by(self):
        finding = the_finding("several_publishers", small_graph(MUX_PASSED_BY + BASE))
        assert finding.summary == "/teleop can drive the robot on /cmd_vel past /twist_mux"
        assert finding.cause == (
            "/twist_mux stands before the robot, but /base hears both: "
            "what /teleop sends does not pass it"
        )
        assert finding.remedy == REMEDY

    def test_an_arbiter_is_passed_by_by_two_before_two_readers(self):
        text = MUX_PASSED_BY + f"/joy joy own\n pub /cmd_vel {TWIST}\n"
        text += BASE + BASE.replace("/base", "/wheels")
        finding = the_finding("several_publishers", small_graph(text))
        assert finding.summary == "/joy and /teleop can drive the robot on /cmd_vel past /twist_mux"
        assert "but /base and /wheels hear all: " in finding.cause

    def test_two_arbiters_pass_nobody_by(self):
        text = MUX + MUX.replace("/twist_mux", "/other_mux")
        finding = the_finding("several_publishers", small_graph(text))
        assert finding.summary == "/other_mux and /twist_mux both drive the robot on /cmd_vel"

    def test_a_viewer_is_no_reader(self):
        graph = small_graph(TWO_DRIVERS + BASE.replace(" driver ", " rviz2 "))
        assert the_finding("several_publishers", graph).certainty is Certainty.LIKELY

    @pytest.mark.parametrize(
        ("one", "other", "is_found"),
        [
            ("nav2_controller", "nav2_behaviors", False),
            ("nav2_controller", "teleop", True),
            ("nav2_controller", "moveit_servo", True),
            ("my_nav2_controller", "nav2_behaviors", True),
            ("nav2_collision_monitor", "nav2_behaviors", True),
            ("nav2_collision_monitor", "opennav_docking", False),
            ("twist_mux", "opennav_docking", True),
        ],
    )
    def test_the_nodes_of_one_stack_take_turns(self, one, other, is_found):
        text = TWO_DRIVERS.replace(" planner ", f" {one} ").replace(" teleop ", f" {other} ")
        assert bool(found("several_publishers", small_graph(text))) is is_found

    def test_nodes_that_the_graph_does_not_list_are_no_stack(self):
        graph = replace(small_graph(TWO_DRIVERS), nodes=())
        assert found("several_publishers", graph)

    def test_a_base_that_publishes_its_own_input_is_no_second_driver(self):
        base = f"/base driver own\n    sub /cmd_vel {TWIST}\n    pub /cmd_vel {TWIST}\n"
        nav = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
        assert not found("several_publishers", small_graph(base + nav))
        both = the_finding("several_publishers", small_graph(base + TWO_DRIVERS))
        assert both.summary == "/move_base and /teleop both drive the robot on /cmd_vel"
        assert found("several_publishers", small_graph(base + nav + BASE.replace("/base", "/arm")))

    def test_the_same_nodes_on_several_topics_are_one_finding(self):
        more = TWO_DRIVERS.replace("/cmd_vel", "/sim/cmd_vel")
        finding = the_finding("several_publishers", small_graph(TWO_DRIVERS + more))
        assert finding.topics == ("/cmd_vel", "/sim/cmd_vel")
        assert finding.summary.endswith("both drive the robot on /cmd_vel and /sim/cmd_vel")
        other_reader = small_graph(TWO_DRIVERS + more + BASE)
        assert len(found("several_publishers", other_reader)) == 2

    @pytest.mark.parametrize(("node", "is_found"), [("/teleop", False), ("/other", True)])
    def test_a_topic_pub_of_the_launch_that_sends_once_is_no_driver(self, node, is_found):
        once = (WiringFact(kind=WiringFactKind.SENT_ONCE, subject=node),)
        text = TWO_DRIVERS.replace(" teleop ", " rostopic ")
        assert bool(found("several_publishers", small_graph(text, wiring=once))) is is_found

    @pytest.mark.parametrize("name", ["prev_cmd", "last_cmd_vel"])
    def test_what_tells_of_a_command_afterwards_is_none(self, name):
        text = TWO_DRIVERS.replace("/cmd_vel", f"/arm/{name}")
        assert not found("several_publishers", small_graph(text))

    def test_an_emergency_stop_is_set_and_released(self):
        text = TWO_DRIVERS.replace(f"/cmd_vel {TWIST}", "/wheels/emergency_stop std_msgs/msg/Bool")
        summary = the_finding("several_publishers", small_graph(text)).summary
        assert "both set and release the emergency stop on /wheels/emergency_stop" in summary

    def test_one_node_with_two_publishers_is_one(self):
        text = f"/nav nav own\n pub /cmd_vel {TWIST}\n pub /cmd_vel {TWIST}\n"
        assert not found("several_publishers", small_graph(text))


class TestOpenCommand:
    def test_one_finding_names_all_topics(self):
        text = BASE + BASE.replace("/base", "/arm").replace("/cmd_vel", "/arm_cmd_vel")
        finding = the_finding("open_command", small_graph(text))
        assert finding.summary == "any node on the network can drive /arm and /base"
        assert finding.cause == (
            "/arm and /base obey /arm_cmd_vel and /cmd_vel, which no node of this launch publishes"
        )
        assert finding.topics == ("/arm_cmd_vel", "/cmd_vel")

    def test_what_was_not_read_may_publish_it(self):
        graph = small_graph(BASE + FIRMWARE, unread=("/firmware",))
        cause = the_finding("open_command", graph).cause
        assert cause.endswith("publishes, unless /firmware (not read) does")

    def test_code_that_may_publish_it_is_named(self):
        place = Evidence(file="src/gui.py", line=7)
        kind = WiringFactKind.UNREAD_PUBLISHER
        fact = WiringFact(kind=kind, subject="/cmd_vel", evidence=(place,))
        finding = the_finding("open_command", small_graph(BASE, wiring=(fact,)))
        assert finding.cause.endswith("publishes, unless src/gui.py:7 does")

    def test_it_is_for_auditors(self):
        finding = the_finding("open_command", small_graph(BASE))
        assert (finding.level, finding.certainty) == (FindingLevel.AUDITOR, Certainty.POSSIBLE)

    def test_what_a_stack_always_listens_to_does_not_count(self):
        text = BASE.replace(" driver ", " nav2_behaviors ").replace("/cmd_vel", "/cmd_vel_teleop")
        assert not found("open_command", small_graph(text))

    def test_an_emergency_stop_can_be_released_by_anybody(self):
        text = "/base driver own\n    sub /e_stop std_msgs/msg/Bool"
        summary = the_finding("open_command", small_graph(text)).summary
        assert summary == "any node on the network can stop and release /base"

    @pytest.mark.parametrize("type", ["sensor_msgs/msg/Joy", "std_msgs/msg/String"])
    def test_what_moves_nothing_by_itself_does_not_count(self, type):
        assert not found("open_command", small_graph(f"/teleop teleop own\n    sub /joy {type}"))

    def test_spare_inputs_of_an_arbiter_do_not_count_while_another_is_in_use(self):
        nav = f"/nav nav own\n pub /nav_vel {TWIST}\n"
        assert not found("open_command", small_graph(MUX + BASE + nav))
        assert the_finding("open_command", small_graph(MUX + BASE)).topics == (
            "/joy_vel",
            "/nav_vel",
        )


class TestCommandTimeout:
    @pytest.mark.parametrize("value", [0, 0.0, -1, -0.5])
    @pytest.mark.parametrize("name", ["cmd_vel_timeout", "base_controller.cmd_vel_timeout"])
    def test_0_and_less_turn_it_off(self, name, value):
        graph = small_graph(BASE, parameters=parameters(name, base=value))
        finding = the_finding("command_timeout", graph)
        assert finding.summary == "/base keeps its last command for ever when its sender dies"
        assert finding.cause == f"its parameter {name} is {value}: no timeout"
        assert finding.remedy == f"set {name} to 0.5 or less"
        assert finding.severity is Severity.HIGH

    @pytest.mark.parametrize("value", [0.1, 1, True, False, None, "0", "", (0,), float("nan")])
    def test_other_values_do_not(self, value):
        graph = small_graph(BASE, parameters=parameters("cmd_vel_timeout", base=value))
        assert not found("command_timeout", graph)

    @pytest.mark.parametrize("name", ["timeout", "my_cmd_vel_timeout", "cmd_vel_timeout.enabled"])
    def test_other_parameters_do_not(self, name):
        assert not found("command_timeout", small_graph(BASE, parameters=parameters(name, base=0)))

    def test_a_node_with_two_is_one_finding(self):
        values = [
            NodeParameter(node="/base", name=name, value=0)
            for name in ("b.reference_timeout", "a.cmd_vel_timeout")
        ]
        graph = small_graph(BASE, parameters=tuple(values))
        assert the_finding("command_timeout", graph).cause == (
            "its parameter a.cmd_vel_timeout is 0 and b.reference_timeout is 0: no timeout"
        )

    def test_a_driver_in_whose_source_nothing_looks_at_the_age_of_commands(self):
        device, aged = wiring_of("device", "CAN"), wiring_of("command_age", "age")
        kept = wiring_of("last_message", "unnoticed")
        graph = small_graph(BASE)
        ends = tuple(replace(each, evidence=kept.evidence) for each in graph.endpoints)
        graph = replace(graph, endpoints=ends, wiring=(device, kept))
        finding = the_finding("command_timeout", graph)
        assert finding.cause == (
            "nothing in the source of /base looks at the age of commands on /cmd_vel"
        )
        assert (finding.severity, finding.level) == (Severity.HIGH, FindingLevel.REGULAR)
        assert (finding.topics, finding.evidence) == (("/cmd_vel",), device.evidence)
        for facts in ((device, kept, aged), (device, wiring_of("last_message", "stopped"))):
            assert not found("command_timeout", replace(graph, wiring=facts))
        assert not found("command_timeout", replace(graph, wiring=(device,)))

    @pytest.mark.parametrize(
        ("relay", "fate", "is_found"),
        [
            (RADIO, "repeated", True),
            (RADIO + "    sub /stop std_msgs/msg/Bool\n", "repeated", True),
            (RADIO + "    sub /odom nav_msgs/msg/Odometry\n", "repeated", True),
            (RADIO.replace("/channels x/msg/Channels", f"/nav_vel {TWIST}"), "repeated", True),
            (RADIO, "unnoticed", False),
            (RADIO, "checked", False),
            (RADIO.replace("x/msg/Channels", "geometry_msgs/msg/Pose"), "repeated", False),
            (RADIO.replace("/cmd_vel", "/other_vel"), "repeated", True),
            (RADIO.replace("/cmd_vel", "/arduino/pwm") + FIRMWARE, "repeated", True),
            (RADIO.replace("/cmd_vel", "/wheel_speeds") + FIRMWARE, "repeated", False),
        ],
    )
    def test_who_repeats_the_last_command_for_ever(self, relay, fate, is_found):
        kept, aged = (
            wiring_of("last_message", fate, "/radio"),
            wiring_of("command_age", "", "/radio"),
        )
        assert bool(found("command_timeout", relaying(relay, kept))) == is_found
        assert not found("command_timeout", relaying(relay, kept, aged))

    def test_what_is_told_of_who_repeats_it(self):
        kept = wiring_of("last_message", "repeated", "/radio")
        finding = the_finding("command_timeout", relaying(RADIO, kept))
        assert finding.cause == "/radio sends its last command for ever when /channels ends"
        assert (finding.severity, finding.level) == (Severity.HIGH, FindingLevel.REGULAR)
        assert finding.topics == ("/channels",)

    @pytest.mark.parametrize(
        ("relay", "known", "is_found"),
        [
            (SHOWING, {"/cmd_vel"}, True),
            (SHOWING, {"/cmd_vel", "/shown"}, True),
            (SHOWING, {"/shown"}, False),
            (RADIO, {"/gone"}, False),
            (SHOWING, (), False),
        ],
    )
    def test_what_is_repeated_must_go_to_what_drives(self, relay, known, is_found):
        kept = wiring_of("last_message", "repeated", "/radio")
        places = {topic: Evidence(file="radio.cpp", line=len(topic)) for topic in known}
        fact = replace(kept, evidence=(*kept.evidence, *places.values()))
        graph = relaying(relay, kept)
        ends = tuple(
            replace(e, evidence=(places[e.topic],)) if e.topic in places else e
            for e in graph.endpoints
        )
        facts = (fact, replace(fact, kind=WiringFactKind.MESSAGE_FLOW, value=""))
        findings = found("command_timeout", replace(graph, endpoints=ends, wiring=facts))
        assert [each.topics for each in findings] == [("/channels",)] * is_found

    def test_only_the_velocity_that_is_repeated_is_named(self):
        kept = wiring_of("last_message", "repeated", "/radio")
        second = f"/nav_vel {TWIST}\n    sub /other_vel {TWIST}"
        graph = relaying(RADIO.replace("/channels x/msg/Channels", second), kept)
        ends = tuple(
            replace(e, evidence=() if e.topic == "/other_vel" else e.evidence)
            for e in graph.endpoints
        )
        finding = the_finding("command_timeout", replace(graph, endpoints=ends))
        assert finding.cause == "/radio sends its last command for ever when /nav_vel ends"

    @pytest.mark.parametrize("type", ["std_msgs/msg/Float64", "sensor_msgs/msg/Imu"])
    def test_a_driver_that_obeys_no_velocity_may_keep_its_last_command(self, type):
        graph = small_graph(BASE.replace(TWIST, type), wiring=(wiring_of("device", "CAN"),))
        assert not found("command_timeout", graph)

    def test_a_timeout_that_is_turned_off_counts_before_the_source(self):
        values = parameters("cmd_vel_timeout", base=0)
        graph = small_graph(BASE, wiring=(wiring_of("device", "CAN"),), parameters=values)
        assert the_finding("command_timeout", graph).certainty is Certainty.CERTAIN


class TestNetworkBridge:
    BRIDGE = "/bridge rosbridge_server third_party\n"
    INCLUDED = UnresolvedItem(
        what="include a", why="gone", package="rosbridge_server", hides=HiddenPart.NODES
    )

    @pytest.mark.parametrize("address", [None, "", "0.0.0.0", "192.168.1.7", 127])
    def test_on_every_address(self, address):
        graph = small_graph(self.BRIDGE, parameters=parameters("address", bridge=address))
        finding = the_finding("network_bridge", graph)
        assert (finding.certainty, finding.level) == (Certainty.CERTAIN, FindingLevel.REGULAR)
        assert finding.severity is Severity.HIGH

    @pytest.mark.parametrize("address", ["127.0.0.1", "localhost", "::1"])
    def test_on_the_local_address_only(self, address):
        graph = small_graph(self.BRIDGE, parameters=parameters("address", bridge=address))
        finding = the_finding("network_bridge", graph)
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)
        assert finding.cause.endswith(f"; it listens on {address}")

    def test_the_address_of_another_node_does_not_count(self):
        graph = small_graph(self.BRIDGE, parameters=parameters("address", other="127.0.0.1"))
        cause = the_finding("network_bridge", graph).cause
        assert cause.endswith("it listens on every address by default")

    def test_it_names_the_commands_in_reach(self):
        finding = the_finding("network_bridge", small_graph(self.BRIDGE + BASE))
        assert finding.summary == (
            "/bridge opens the app to the network: WebSocket clients can publish on every topic, "
            "/cmd_vel included"
        )

    def test_one_that_is_included_and_not_in_the_source_is_likely(self):
        place = Evidence(file="base.launch", line=7)
        note = replace(self.INCLUDED, evidence=(place,))
        finding = the_finding("network_bridge", small_graph(BASE, unresolved=(note,)))
        assert (finding.subject, finding.certainty) == ("rosbridge_server", Certainty.LIKELY)
        assert finding.summary.startswith("rosbridge_server opens the app to the network")
        assert finding.evidence == (place,)

    @pytest.mark.parametrize("package", ["web_video_server", "rosboard"])
    def test_a_server_that_only_shows_is_an_oddity(self, package):
        finding = the_finding("network_bridge", small_graph(f"/web {package} third_party"))
        assert (finding.severity, finding.level) == (Severity.LOW, FindingLevel.PEDANTIC)
        assert finding.summary.startswith("/web shows the app to the network")

    def test_one_that_is_started_and_included_is_one_finding(self):
        graph = small_graph(self.BRIDGE, unresolved=(self.INCLUDED,))
        finding = the_finding("network_bridge", graph)
        assert finding.subject == "/bridge"

    @pytest.mark.parametrize(
        ("package", "hides"),
        [
            ("my_rosbridge_server_too", HiddenPart.NODES),
            ("", HiddenPart.NODES),
            ("rosbridge_server", None),
        ],
    )
    def test_other_notes_are_no_bridge(self, package, hides):
        note = replace(self.INCLUDED, package=package, hides=hides)
        assert not found("network_bridge", small_graph(BASE, unresolved=(note,)))


@pytest.mark.parametrize(
    ("type", "level"), [("VehicleCommand", "pedantic"), ("TrajectorySetpoint", "regular")]
)
def test_requests_that_are_done_one_by_one_are_for_the_pedantic(type, level):
    nodes = (f"/{name} {name} own\n    pub /fmu/in/x px4_msgs/msg/{type}\n" for name in "ab")
    assert the_finding("several_publishers", small_graph("".join(nodes))).level == level


class TestLostCommand:
    LOST = BASE.replace("/cmd_vel", "/base/cmd_vel") + f"/nav nav own\n    pub /cmd_vel {TWIST}\n"

    def test_it_says_who_is_not_heard_and_what_is(self):
        finding = the_finding("lost_command", small_graph(self.LOST))
        assert finding.summary == "what /nav commands on /cmd_vel reaches nobody"
        assert finding.cause == (
            "no node of this launch subscribes it; "
            "/base obeys /base/cmd_vel, which nobody publishes"
        )
        assert finding.remedy == "remap /cmd_vel to /base/cmd_vel"
        assert (finding.severity, finding.level) == (Severity.MEDIUM, FindingLevel.REGULAR)

    UNSTAMPED = LOST.replace(f"pub /cmd_vel {TWIST}", f"pub /base/cmd_vel_unstamped {TWIST}")

    def test_a_command_may_lack_the_stamp_too(self):
        text = self.UNSTAMPED.replace(f"/base/cmd_vel {TWIST}", f"/base/cmd_vel {STAMPED}")
        finding = the_finding("lost_command", small_graph(text))
        assert finding.cause.endswith("nobody publishes, and takes geometry_msgs/TwistStamped")
        assert finding.remedy.endswith("to /base/cmd_vel, and send geometry_msgs/TwistStamped")
        stamper = f"/stamper s own\n    pub /base/cmd_vel {STAMPED}\n"
        assert not found("lost_command", small_graph(text + stamper))
        accel = self.UNSTAMPED.replace(f"/base/cmd_vel {TWIST}", "/base/cmd_vel x/msg/Accel")
        assert not found("lost_command", small_graph(accel))

    def test_what_a_bridge_carries_for_another_model_of_gazebo_is_not_meant(self):
        fact = WiringFact(kind=WiringFactKind.OTHER_MODEL, subject="/base/cmd_vel")
        for rule in ("lost_command", "unmatched_topic"):
            assert not found(rule, small_graph(self.LOST, wiring=(fact,)))

    def test_an_output_is_not_joined_to_the_input_that_it_is_made_of(self):
        mux = f"/mux mux own\n    sub /cmd_vel {TWIST}\n    pub /mixed {TWIST}\n"
        smoother = f"/smoother s own\n    sub /mixed {TWIST}\n    pub /base/cmd_vel {TWIST}\n"
        assert not found("lost_command", small_graph(mux + smoother))
        assert found("lost_command", small_graph(mux + smoother.replace("/mixed", "/other")))

    def test_a_subscription_of_a_name_known_in_part_may_be_its_end(self):
        end = Endpoint(
            node="/mux",
            topic="/{?}",
            direction=Direction.SUBSCRIBE,
            resolution=Resolution.SYMBOLIC,
        )
        graph = small_graph(self.LOST)
        assert not found("lost_command", replace(graph, endpoints=(*graph.endpoints, end)))

    def test_a_node_that_was_not_read_may_hear_it(self):
        graph = small_graph(self.LOST + FIRMWARE, unread=("/firmware",))
        finding = the_finding("lost_command", graph)
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)
        assert finding.remedy.startswith("find out who should obey /cmd_vel; /")

    @pytest.mark.parametrize(
        "other",
        [
            "/robot2/cmd_vel",  # another robot's
            "/base/motor_odom",  # no command
        ],
    )
    def test_a_command_beside_it_is_another_one(self, other):
        text = self.LOST.replace("pub /cmd_vel", f"pub {other}")
        assert not found("lost_command", small_graph(text))

    @pytest.mark.parametrize(
        "name", ["measured_vel", "gps_velocity", "vel_estimate", "velocity_estimated", "navsat/vel"]
    )
    def test_a_velocity_that_is_measured_or_estimated_commands_nothing(self, name):
        lost = f"/nav nav own\n pub /{name} {TWIST}\n"
        assert not found("lost_command", small_graph(f"{lost}/b b own\n sub /x/{name} {TWIST}\n"))
        name = name.replace("navsat/vel", "vel") if "/" in name else "vel"
        lost = f"/nav nav own\n pub /{name} {TWIST}\n"
        assert found("lost_command", small_graph(f"{lost}/b b own\n sub /x/{name} {TWIST}\n"))

    NEAR = LOST.replace("/base/cmd_vel", "/base_cmd_vel")

    def test_a_near_name_counts_where_all_was_read(self):
        assert found("lost_command", small_graph(self.NEAR))
        unread = small_graph(self.NEAR + FIRMWARE, unread=("/firmware",))
        assert not found("lost_command", unread)

    @pytest.mark.parametrize(
        ("lost", "obeyed"),
        [
            ("/robot2/cmd_vel", "/robot1/cmd_vel"),
            ("/right_arm/command", "/left_arm/command"),
            ("/cmd_vel_2", "/cmd_vel_1"),
        ],
    )
    def test_another_robot_s_or_arm_s_command_is_not_meant(self, lost, obeyed):
        text = f"/base driver own\n sub {obeyed} {TWIST}\n/nav nav own\n pub {lost} {TWIST}\n"
        assert not found("lost_command", small_graph(text))

    @pytest.mark.parametrize(
        ("base", "level"),
        [("/base_cmd_vel", "pedantic"), ("/chassis", "pedantic"), ("/base/odom", "regular")],
    )
    def test_who_commands_nobody_does_not_drive_the_robot(self, base, level):
        text = self.NEAR.replace("/base_cmd_vel", base) + f"/joy joy own\n pub /cmd_vel {TWIST}\n"
        assert the_finding("several_publishers", small_graph(text)).level == level

    def test_another_type_is_another_topic(self):
        text = self.LOST.replace(f"pub /cmd_vel {TWIST}", "pub /cmd_vel x/msg/Accel")
        assert not found("lost_command", small_graph(text))

    def test_who_publishes_both_does_so_on_purpose(self):
        text = self.LOST + f"/nav nav own\n    pub /base/cmd_vel {TWIST}\n"
        assert not found("lost_command", small_graph(text))

    def test_who_forwards_what_it_obeys_is_no_sender_of_its_own(self):
        text = f"/base driver own\n sub /cmd_vel {TWIST}\n pub /motor/cmd_vel {TWIST}\n"
        assert not found("lost_command", small_graph(text))

    def test_the_autopilot_reads_its_inputs(self):
        text = self.LOST.replace("pub /cmd_vel", "pub /fmu/in/cmd_vel")
        text = text.replace("sub /base/cmd_vel", "sub /cmd_vel")
        finding = the_finding("lost_command", small_graph(text))
        assert finding.level is FindingLevel.PEDANTIC
        finding = the_finding("lost_command", small_graph(text.replace("/fmu/in", "/fmu/on")))
        assert finding.level is FindingLevel.REGULAR

    def test_a_display_that_shows_it_is_a_reader(self):
        text = self.LOST + f"/rviz rviz2 third_party\n    sub /cmd_vel {TWIST}\n"
        assert not found("lost_command", small_graph(text))


class TestCommandsOfOtherNames:
    """A command that nobody reads, and an obeyed topic that nobody sends, of unlike names."""

    NAV = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
    WHEELS = f"/base driver own\n    sub /chassis {TWIST}\n"

    def lost(self, *texts, **keys):
        return [finding.topics for finding in found("lost_command", small_graph(*texts, **keys))]

    def test_the_two_are_one_finding(self):
        graph = small_graph(self.NAV + self.WHEELS)
        finding = the_finding("lost_command", graph)
        assert finding.summary == "what /nav commands on /cmd_vel reaches nobody"
        assert finding.cause == (
            "no node of this launch subscribes it; /base obeys /chassis, which nobody publishes"
        )
        assert finding.remedy == "remap /cmd_vel to /chassis"
        assert (finding.certainty, finding.level) == (Certainty.LIKELY, FindingLevel.REGULAR)
        assert not found("open_command", graph)
        assert not found("unmatched_topic", graph)

    @pytest.mark.parametrize(
        "more",
        [
            f"/joy joy own\n    pub /chassis {TWIST}\n",  # somebody sends it
            f"/log log own\n    sub /cmd_vel {TWIST}\n",  # somebody reads it
            f"/arm arm own\n    sub /crane {TWIST}\n",  # which of two is meant?
            f"/joy joy own\n    pub /auto {TWIST}\n/base driver own\n    sub /auto {TWIST}\n",
            f"/nav nav own\n    pub /auto {TWIST}\n/log log own\n    sub /auto {TWIST}\n",
        ],
    )
    def test_they_are_not_joined_where_one_has_its_other_end_or_the_pair_is_not_clear(self, more):
        assert self.lost(self.NAV + self.WHEELS)
        assert not self.lost(self.NAV + self.WHEELS + more)

    @pytest.mark.parametrize(
        ("lost", "obeyed", "is_joined"),
        [
            ("/joy_cmd_vel", "/base/chassis", True),
            ("/left_arm/cmd_vel", "/right_arm/cmd_vel", False),
            ("/left/arm_cmd", "/right/arm_cmd", False),
            ("/cmd_vel_1", "/cmd_vel_2", False),
            ("/wheels/measured_vel", "/chassis", False),
            ("/cmd_vel", "/chassis/estimated_vel", False),
            ("/cmd_vel", "/chassis/cmd_vel_actual", False),
            ("/cmd_vel_raw", "/chassis", True),
        ],
    )
    def test_twins_and_measurements_are_not_joined(self, lost, obeyed, is_joined):
        text = self.NAV.replace("/cmd_vel", lost) + self.WHEELS.replace("/chassis", obeyed)
        assert bool(self.lost(text)) is is_joined

    @pytest.mark.parametrize(
        ("obeyed", "reader", "is_joined"),
        [
            ("/chassis/jog", "/base", True),
            ("/gimbal/jog_cmd", "/base", False),
            ("/jog_cmd", "/gimbal", False),
            ("/jog_cmd", "/base", True),
        ],
    )
    def test_what_moves_another_thing_is_not_joined(self, obeyed, reader, is_joined):
        text = self.WHEELS.replace("/chassis", obeyed).replace("/base", reader)
        assert bool(self.lost(self.NAV + text)) is is_joined

    def test_nodes_of_two_robots_are_not_joined(self):
        text = self.NAV.replace("/nav", "/alice/nav") + self.WHEELS.replace("/base", "/{}/base")
        assert self.lost(text.replace("/{}", "/alice"))
        assert not self.lost(text.replace("/{}", "/bob"))

    @pytest.mark.parametrize(("name", "is_joined"), [("/twist", False), ("/cmd_vel", True)])
    def test_who_tells_where_it_moved_commands_by_a_name_alone(self, name, is_joined):
        driver = f"/nav nav own\n    pub {name} {TWIST}\n    pub /odom nav_msgs/msg/Odometry\n"
        assert bool(self.lost(driver + self.WHEELS)) is is_joined
        alone = driver.partition("    pub /odom")[0]
        assert self.lost(alone + self.WHEELS)

    def test_a_plain_type_says_too_little(self):
        text = (self.NAV + self.WHEELS.replace("/chassis", "/mast/cmd")).replace(
            TWIST, "std_msgs/msg/Float64"
        )
        assert not self.lost(text)

    def test_what_behaviors_of_a_stack_may_obey_is_not_meant(self):
        behaviors = f"/behaviors nav2_behaviors own\n    sub /chassis {TWIST}\n"
        behaviors += f"    pub /auto {TWIST}\n/base driver own\n    sub /auto {TWIST}\n"
        assert not self.lost(self.NAV + behaviors)
        assert self.lost(self.NAV + behaviors.replace("nav2_behaviors", "nav2_collision_monitor"))

    @pytest.mark.parametrize(
        ("node", "package", "is_joined"),
        [
            ("/camera", "realsense2_camera", True),
            ("/rplidar", "rplidar_ros", True),
            ("/rover/camera", "realsense2_camera", True),
            ("/velodyne", "velodyne_driver", True),
            ("/driver", "acme_lidar_driver", True),
            ("/base_driver", "acme_base", False),
            ("/rover", "camera_rover_driver", False),
            ("/camera", "camera_rover_driver", False),
            ("/camera_base", "acme", False),
            ("/mixer", "acme", False),
        ],
    )
    def test_a_node_that_was_not_read_weakens_what_it_may_join(self, node, package, is_joined):
        text = f"{self.NAV}{self.WHEELS}{node} {package} third_party\n"
        graph = small_graph(text, unread=(node,))
        assert bool(found("lost_command", graph)) is is_joined
        assert bool(found("open_command", graph)) is not is_joined

    @pytest.mark.parametrize(
        ("what", "is_joined"),
        [
            ("include $(find rover_bringup)/launch/camera.launch", True),
            ("include $(find acme_description)/launch/all.launch", True),
            ("robot_description", True),
            ("include $(find camera_rover_driver)/launch/all.launch", False),
            ("include $(find acme)/launch/robot_with_camera.launch", False),
        ],
    )
    def test_a_file_that_was_not_read_weakens_what_it_may_join(self, what, is_joined):
        notes = (UnresolvedItem(what=what, why="gone", hides=HiddenPart.NODES),)
        assert bool(self.lost(self.NAV + self.WHEELS, unresolved=notes)) is is_joined

    @pytest.mark.parametrize(
        ("names", "is_joined"),
        [
            (("/arm/cmd_vel", "/arm/cmd_vel_stamped"), True),
            (("/arm/cmd_vel", "/cmd_vel"), False),
            (("/chassis",), False),
            (("/odom",), False),  # its commands have the names that its source gives them
            ((), False),
        ],
    )
    def test_a_node_that_is_given_names_of_commands_joins_no_others(self, names, is_joined):
        kind = WiringFactKind.UNREAD_NODE
        facts = (WiringFact(kind=kind, subject="/twist_stamper", others=names),)
        text = f"{self.NAV}{self.WHEELS}/twist_stamper twist_stamper third_party\n"
        graph = small_graph(text, unread=("/twist_stamper",), wiring=facts)
        assert bool(found("lost_command", graph)) is is_joined

    @pytest.mark.parametrize(
        ("type", "is_joined"), [(TWIST, False), ("", False), ("sensor_msgs/msg/Image", True)]
    )
    @pytest.mark.parametrize("direction", Direction)
    def test_a_name_known_in_part_weakens_topics_of_its_type(self, direction, type, is_joined):
        end = Endpoint(node="/mix", topic="/{?}", type=type, direction=direction)
        graph = small_graph(self.NAV + self.WHEELS)
        graph = replace(graph, endpoints=(*graph.endpoints, end))
        assert bool(found("lost_command", graph)) is is_joined


class TestPowerCommand:
    BRIDGE = "/bridge rosbridge_server third_party\n"
    POWER = "/leo leo own\n    sub /system/shutdown std_msgs/msg/Empty\n"

    def test_a_bridge_lets_strangers_do_it(self):
        finding = the_finding("power_command", small_graph(self.POWER + self.BRIDGE))
        assert finding.summary == "whoever reaches /bridge can switch the robot off"
        assert finding.cause.startswith("/leo obeys /system/shutdown, which no node")
        assert (finding.severity, finding.level) == (Severity.MEDIUM, FindingLevel.REGULAR)

    def test_without_one_it_is_for_the_pedantic(self):
        finding = the_finding("power_command", small_graph(self.POWER))
        assert finding.summary == "any node on the network can switch the robot off"
        assert finding.level is FindingLevel.PEDANTIC

    def test_a_restart_is_told_as_such(self):
        text = self.POWER.replace("shutdown", "reboot")
        summary = the_finding("power_command", small_graph(text)).summary
        assert summary == "any node on the network can restart the robot or a part of it"

    @pytest.mark.parametrize(
        ("name", "is_found"),
        [
            ("/reboot", True),
            ("/robot_power_off", True),
            ("/leo/shut_down", True),
            ("/shutdown_status_page", True),
            ("/shutdowns", False),
            ("/reboots/last", False),
            ("/power", False),
            ("/base/reset", False),
            ("/mcu_reset", True),
            ("/restart_motors", True),
            ("/reset_odometry", False),
            ("/presets", False),
        ],
    )
    def test_services_count_by_their_last_part(self, name, is_found):
        graph = small_graph(BASE, services=(Service(node="/base", name=name),))
        assert bool(found("power_command", graph)) is is_found

    def test_what_the_app_uses_or_the_library_offers_does_not_count(self):
        service = Service(node="/base", name="/reboot")
        client = ServiceClient(node="/nav", name="/reboot")
        assert not found("power_command", small_graph(BASE, services=(service,), clients=(client,)))
        hidden = replace(service, implicit=True)
        assert not found("power_command", small_graph(BASE, services=(hidden,)))
        used = self.POWER + "/ui ui own\n    pub /system/shutdown std_msgs/msg/Empty\n"
        assert not found("power_command", small_graph(used))


class TestArbiter:
    def test_is_for_auditors(self):
        finding = the_finding("arbiter", small_graph(MUX))
        assert finding.level is FindingLevel.AUDITOR
        assert finding.summary == "/twist_mux decides who drives on /cmd_vel"
        assert finding.cause == "it takes /joy_vel, /nav_vel"

    def test_priorities_and_locks_are_those_of_its_parameters(self):
        given = {
            "topics.joy.topic": "joy_vel",
            "topics.joy.priority": 100,
            "topics.nav.topic": "/nav_vel",
            "locks.pause.topic": "/pause",
            "locks.pause.priority": 255,
            "topics.a.b.topic": "x",
        }
        known = [
            each for name, value in given.items() for each in parameters(name, twist_mux=value)
        ]
        others = parameters("topics.joy.priority", other=1)
        finding = the_finding("arbiter", small_graph(MUX, parameters=(*known, *others)))
        assert finding.cause == (
            "it takes /joy_vel (priority 100), /nav_vel, lock /pause (priority 255)"
        )

    def test_inputs_of_one_last_name_have_their_own_priorities(self):
        text = MUX.replace("/{nav,joy}_vel", "/{nav,joy}/cmd_vel")
        given = {
            "topics.a-joy.topic": "joy/cmd_vel",
            "topics.a-joy.priority": 100,
            "topics.nav.topic": "nav/cmd_vel",
            "topics.nav.priority": 10,
            "locks.cmd_vel.topic": "cmd_vel",
            "locks.cmd_vel.priority": 255,
        }
        known = [parameters(name, twist_mux=value) for name, value in given.items()]
        finding = the_finding("arbiter", small_graph(text, parameters=sum(known, ())))
        assert finding.cause == (
            "it takes /joy/cmd_vel (priority 100), /nav/cmd_vel (priority 10), "
            "lock /cmd_vel (priority 255)"
        )

    def test_without_an_output_it_decides_nothing(self):
        assert not found("arbiter", small_graph(MUX.replace("    pub ", "    sub ")))


def test_a_node_that_moves_nothing_is_no_reader_that_was_not_read():
    text = TWO_DRIVERS + "/camera realsense third_party\n/roboclaw motors third_party\n"
    cause = the_finding("several_publishers", small_graph(text, unread=("/camera",))).cause
    assert cause.endswith("; its reader is not in the source")
    both = small_graph(text, unread=("/camera", "/roboclaw"))
    cause = the_finding("several_publishers", both).cause
    assert cause.endswith("it may be /roboclaw (not read)")


def test_a_speed_limit_is_no_drive():
    graph = small_graph(TWO_DRIVERS.replace(f"/cmd_vel {TWIST}", "/max_vel std_msgs/msg/Float64"))
    finding = the_finding("several_publishers", graph)
    assert finding.summary == "/move_base and /teleop both set the robot's speed limit on /max_vel"


class TestSeveralClients:
    def test_tells_the_server_and_the_clients(self):
        server = "/nav nav2_bt_navigator own\n server {} nav2_msgs/action/NavigateToPose\n"
        text = (GOALS + server).replace("{}", "/navigate_to_pose")
        finding = the_finding("several_clients", small_graph(text))
        assert finding.summary == "/goals and /mission both send goals to /navigate_to_pose"
        assert finding.cause == (
            "nothing decides between them: /nav takes the goal that comes last"
        )
        assert (finding.level, finding.topics) == (FindingLevel.PEDANTIC, ("/navigate_to_pose",))

    def test_a_server_that_passes_on_goals_to_itself_does_not_count(self):
        server = "/goals goals own\n server {} nav2_msgs/action/NavigateToPose\n"
        text = (GOALS + server).replace("{}", "/navigate_to_pose")
        assert not found("several_clients", small_graph(text))

    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ("/goals goals own", "/rviz rviz2 third_party"),
            ("NavigateToPose", "ComputePathToPose"),
            (" mission own", " nav2_waypoint_follower own"),
        ],
    )
    def test_viewers_other_actions_and_one_stack_do_not_count(self, old, new):
        text = GOALS.format("/navigate_to_pose").replace(old, new)
        text = text.replace(" goals own", " nav2_bt_navigator own")
        assert not found("several_clients", small_graph(text))


class TestMavros:
    TEXT = f"/mavros mavros third_party\n    sub /setpoint_velocity/cmd_vel {STAMPED}\n"

    @pytest.mark.parametrize(
        ("url", "level"),
        [
            ("udp://:14550@10.0.0.9:14550", FindingLevel.REGULAR),
            (None, FindingLevel.PEDANTIC),
        ],
    )
    def test_a_link_to_ground_stations_opens_the_app(self, url, level):
        graph = small_graph(self.TEXT, parameters=parameters("gcs_url", mavros=url))
        finding = the_finding("network_bridge", graph)
        assert finding.level is level
        assert "a ground station on its link commands the vehicle" in finding.summary

    def test_of_the_nodes_of_a_process_only_the_router_opens_the_app(self):
        plugins = "/mavros/imu mavros third_party\n    pub /mavros/imu/data sensor_msgs/Imu\n"
        router = "/router mavros third_party\n    pub /uas1/mavlink_source mavros_msgs/Mavlink\n"
        text = f"{self.TEXT}{plugins}{router}"
        finding = the_finding("network_bridge", small_graph(text))
        assert (finding.nodes, finding.level) == (("/router",), FindingLevel.PEDANTIC)
        url = parameters("gcs_url", mavros="udp://10.0.0.9")
        finding = the_finding("network_bridge", small_graph(text, parameters=url))
        assert (finding.nodes, finding.level) == (("/router",), FindingLevel.REGULAR)

    def test_each_process_of_ros1_may_open_the_app(self):
        assert the_finding("network_bridge", small_graph(self.TEXT, ros=1))

    @pytest.mark.parametrize("url", ["", "udp://127.0.0.1:14551@127.0.0.1:14555"])
    def test_no_link_and_a_local_one_do_not(self, url):
        graph = small_graph(self.TEXT, parameters=parameters("gcs_url", mavros=url))
        assert not found("network_bridge", graph)
