"""What the rules on the wiring of an app count, what they leave out, and their words."""

from dataclasses import replace

import pytest
from finding_graphs import (
    BASE,
    FIRMWARE,
    STAMPED,
    TWIST,
    found,
    parameters,
    small_graph,
    the_finding,
)
from finding_pairs import FILTERED, MANAGER, ODOMETRY, SCAN, with_fact

from rtron.findings.near_names import is_near
from rtron.vocabulary import (
    Action,
    ActionRole,
    Certainty,
    Direction,
    Endpoint,
    Evidence,
    FindingLevel,
    Node,
    NodeParameter,
    Resolution,
    Service,
    ServiceClient,
    Severity,
    UnresolvedCause,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.enums import HiddenPart


def nav_and_base(sent: str, expected: str, **resolutions: Resolution):
    graph = small_graph(
        f"/nav nav own\n pub /cmd_vel {sent}\n/base driver own\n sub /cmd_vel {expected}\n"
    )
    ends = [
        replace(end, resolution=resolutions.get(end.node.strip("/"), Resolution.LITERAL))
        for end in graph.endpoints
    ]
    return replace(graph, endpoints=tuple(ends))


class TestTypeMismatch:
    def test_between_two_sources_it_is_certain_and_high(self):
        finding = the_finding("type_mismatch", nav_and_base(TWIST, STAMPED))
        assert finding.summary == "/base gets nothing from /cmd_vel"
        assert finding.cause == (
            "/nav publishes geometry_msgs/Twist, /base expects geometry_msgs/TwistStamped"
        )
        assert finding.remedy == "give both ends one message type"
        assert (finding.certainty, finding.severity) == (Certainty.CERTAIN, Severity.HIGH)
        assert finding.level is FindingLevel.REGULAR

    @pytest.mark.parametrize("type", ["topic_tools/ShapeShifter", "*", "", "msg/Twist"])
    def test_a_reader_of_any_type_or_of_an_unknown_one_gets_it(self, type):
        graph = nav_and_base(TWIST, STAMPED)
        ends = tuple(
            replace(end, type=type) if end.node == "/base" else end for end in graph.endpoints
        )
        assert not found("type_mismatch", replace(graph, endpoints=ends))

    @pytest.mark.parametrize("node", ["nav", "base"])
    def test_with_a_model_it_depends_on_the_distribution(self, node):
        finding = the_finding(
            "type_mismatch", nav_and_base(TWIST, STAMPED, **{node: Resolution.MODEL})
        )
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)
        assert "ROS_DISTRO" in finding.remedy

    def test_where_the_distribution_was_given_a_model_is_certain(self):
        graph = nav_and_base(TWIST, STAMPED, base=Resolution.MODEL)
        fact = WiringFact(kind=WiringFactKind.DISTRIBUTION, subject="jazzy")
        finding = the_finding("type_mismatch", replace(graph, wiring=(fact,)))
        assert (finding.certainty, finding.level) == (Certainty.CERTAIN, FindingLevel.REGULAR)
        assert finding.remedy == "give both ends one message type"

    def test_a_model_with_another_type_than_the_stamped_is_certain(self):
        graph = nav_and_base("std_msgs/msg/String", TWIST, base=Resolution.MODEL)
        assert the_finding("type_mismatch", graph).certainty is Certainty.CERTAIN

    @pytest.mark.parametrize("other", ["geometry_msgs/Twist", "", "*"])
    def test_spelling_and_unknown_types_do_not_part_the_ends(self, other):
        assert not found("type_mismatch", nav_and_base(TWIST, other))
        assert not found("type_mismatch", nav_and_base(other, TWIST))

    def test_a_publisher_of_unknown_type_may_be_the_other_end(self):
        graph = nav_and_base(TWIST, STAMPED)
        end = Endpoint(node="/joy", topic="/cmd_vel", direction=Direction.PUBLISH)
        graph = replace(graph, endpoints=(*graph.endpoints, end))
        assert the_finding("type_mismatch", graph).certainty is Certainty.POSSIBLE

    @pytest.mark.parametrize(
        ("ros", "other", "certainty"),
        [
            (1, "mine/Twist", Certainty.POSSIBLE),
            (2, "mine/Twist", Certainty.CERTAIN),
            (1, "mine/Velocity", Certainty.CERTAIN),
        ],
    )
    def test_copies_of_a_type_may_connect_in_ros1(self, ros, other, certainty):
        graph = replace(nav_and_base(TWIST, other), ros=ros)
        assert the_finding("type_mismatch", graph).certainty is certainty

    def test_one_of_two_publishers_has_no_subscriber_of_its_type(self):
        graph = nav_and_base(TWIST, TWIST)
        ends = [replace(e, node="/joy", type=STAMPED) for e in graph.publishers("/cmd_vel")]
        finding = the_finding("type_mismatch", replace(graph, endpoints=(*graph.endpoints, *ends)))
        assert finding.summary == "nobody gets what /joy publishes on /cmd_vel"
        assert finding.cause == (
            "/joy publishes geometry_msgs/TwistStamped, /base expects geometry_msgs/Twist"
        )
        assert finding.severity is Severity.HIGH

    def test_between_the_ends_of_one_node_it_is_an_oddity(self):
        text = (
            "/costmap move_base own\n pub /footprint a/PolygonStamped\n sub /footprint a/Polygon\n"
        )
        finding = the_finding("type_mismatch", small_graph(text))
        assert (finding.severity, finding.level) == (Severity.LOW, FindingLevel.PEDANTIC)
        assert not found("type_mismatch", small_graph(text.replace("own", "third_party")))

    def test_off_the_motion_topics_it_is_a_failure(self):
        graph = small_graph(
            SCAN.replace("    sub /scan sensor_msgs/msg/LaserScan", " sub /scan a/B")
        )
        assert the_finding("type_mismatch", graph).severity is Severity.MEDIUM


class TestUnmatchedTopic:
    MISSPELT = ODOMETRY.format("filterd")

    def test_a_near_name_that_nobody_reads_is_likely(self):
        finding = the_finding("unmatched_topic", small_graph(self.MISSPELT))
        assert finding.summary == "/nav subscribes /odometry/filterd, which nobody publishes"
        assert finding.cause == (
            "no node of this launch publishes it; /ekf sends /odometry/filtered"
        )
        assert finding.remedy == "did you mean /odometry/filtered? Remap one to the other"
        assert (finding.certainty, finding.level) == (Certainty.LIKELY, FindingLevel.REGULAR)
        assert finding.topics == ("/odometry/filterd", "/odometry/filtered")

    SEEN = """
/camera usb_cam own
    pub /camera/image_raw sensor_msgs/msg/Image
    pub /camera/image_raw/compressed sensor_msgs/msg/CompressedImage
    pub /camera/image_raw/compressedDepth sensor_msgs/msg/CompressedImage
/project lane own
    sub /camera/image_rect_color/compressed sensor_msgs/msg/CompressedImage
    pub /camera/image_projected/compressed sensor_msgs/msg/CompressedImage
"""

    def test_the_only_image_of_a_camera_may_be_meant(self):
        finding = the_finding("unmatched_topic", small_graph(self.SEEN))
        assert finding.meant == "/camera/image_raw/compressed"
        assert finding.remedy.endswith("/camera/image_raw/compressed may be another thing")
        assert finding.level is FindingLevel.REGULAR

    @pytest.mark.parametrize(
        "more",
        [
            "/view view own\n    sub /camera/image_raw/compressed sensor_msgs/msg/CompressedImage",
            "/thermal t own\n    pub /camera/thermal/compressed sensor_msgs/msg/CompressedImage",
        ],
    )
    def test_an_image_that_others_read_or_one_of_several_is_not_meant(self, more):
        assert not found("unmatched_topic", small_graph(f"{self.SEEN}{more}\n"))

    def test_what_is_only_recorded_counts_too(self):
        recorder = "/bag ros2bag third_party\n    sub /odometry/filterd \n"
        only_recorded = self.MISSPELT[: self.MISSPELT.index("/nav ")] + recorder
        finding = the_finding("unmatched_topic", small_graph(only_recorded))
        assert finding.summary == "/bag subscribes /odometry/filterd, which nobody publishes"
        both = recorder + "    sub /odometry/filtered \n"
        assert not found("unmatched_topic", small_graph(only_recorded.replace(recorder, both)))

    @pytest.mark.parametrize(
        ("reader", "level"),
        [
            ("/r/costmap/costmap", FindingLevel.REGULAR),
            ("/r/costmap/other", FindingLevel.PEDANTIC),
        ],
    )
    def test_a_relative_name_of_a_node_in_a_namespace_of_its_own_name(self, reader, level):
        scan = "sensor_msgs/msg/LaserScan"
        text = f"/r/laser driver own\n    pub /r/scan {scan}\n/r/amcl nav2_amcl third_party\n"
        text += (
            f"    sub /r/scan {scan}\n{reader} nav2 third_party\n    sub /r/costmap/scan {scan}\n"
        )
        finding = the_finding("unmatched_topic", small_graph(text))
        assert (finding.meant, finding.level) == ("/r/scan", level)

    def test_with_a_node_that_was_not_read_it_is_only_possible(self):
        graph = small_graph(self.MISSPELT + FIRMWARE, unread=("/firmware",))
        finding = the_finding("unmatched_topic", graph)
        assert finding.certainty is Certainty.POSSIBLE
        assert "it, unless /firmware (not read) does; /ekf sends" in finding.cause

    def test_with_code_that_may_publish_it_it_is_only_possible(self):
        place = Evidence(file="src/ekf.py", line=7)
        kind, topic = WiringFactKind.UNREAD_PUBLISHER, "/odometry/filterd"
        fact = WiringFact(kind=kind, subject=topic, evidence=(place,))
        finding = the_finding("unmatched_topic", small_graph(self.MISSPELT, wiring=(fact,)))
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)
        assert "publishes it, unless src/ekf.py:7 does" in finding.cause

    @pytest.mark.parametrize(
        ("what", "why"),
        [("include", "package 'x' is not here"), ("more_actions", "what it starts is not known")],
    )
    def test_what_was_not_read_is_named_where_all_nodes_were(self, what, why):
        notes = (UnresolvedItem(what=what, why=why, hides=HiddenPart.NODES),)
        finding = the_finding("unmatched_topic", small_graph(self.MISSPELT, unresolved=notes))
        assert finding.certainty is Certainty.POSSIBLE
        assert f"publishes it, unless {what} (not read) does" in finding.cause

    @pytest.mark.parametrize("what", ["include nav.launch.py", "launch x.launch that /a starts"])
    def test_with_a_launch_file_that_was_not_read_it_is_only_possible(self, what):
        notes = (UnresolvedItem(what=what, why="?", hides=HiddenPart.NODES),)
        graph = small_graph(self.MISSPELT, unresolved=notes)
        assert the_finding("unmatched_topic", graph).certainty is Certainty.POSSIBLE

    def test_a_viewer_that_was_not_read_publishes_nothing(self):
        graph = small_graph(self.MISSPELT + "/rviz rviz2 own\n", unread=("/rviz",))
        assert the_finding("unmatched_topic", graph).certainty is Certainty.LIKELY

    def test_a_near_name_that_somebody_reads_is_a_hint_only(self):
        text = self.MISSPELT + "/map map own\n sub /odometry/filtered nav_msgs/msg/Odometry\n"
        finding = the_finding("unmatched_topic", small_graph(text))
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)
        told = "find out who should publish /odometry/filterd; /odometry/filtered may be another"
        assert finding.remedy == f"{told} thing"

    @pytest.mark.parametrize(
        ("expected", "sent", "type", "reader", "is_advised"),
        [
            ("/safety/state", "/state", "a/B", "own", [True]),
            ("/safety/e_stop", "/e_stop", "std_msgs/Bool", "own", [False]),
            ("/detection", "/camera_detection", "a/B", "own", [False]),
            ("/set_pose", "/pose", "geometry_msgs/PoseStamped", "third_party", []),
            ("/map/initialpose", "/initialpose", "a/B", "third_party", [True]),
        ],
    )
    def test_no_remap_is_advised_that_may_feed_a_node_with_something_else(
        self, expected, sent, type, reader, is_advised
    ):
        text = f"/one one {reader}\n sub {expected} {type}\n/two two own\n pub {sent} {type}\n"
        text += "/three three own\n sub /e_stop std_msgs/Bool\n"
        remedies = [each.remedy for each in found("unmatched_topic", small_graph(text))]
        assert ["Remap" in each for each in remedies] == is_advised

    def test_a_near_name_of_another_type_is_none(self):
        text = self.MISSPELT.replace("pub /odometry/filtered nav_msgs", "pub /odometry/filtered my")
        assert not found("unmatched_topic", small_graph(text))
        assert the_finding("incomplete_launch", small_graph(text)).level is FindingLevel.PEDANTIC

    @pytest.mark.parametrize(
        ("other", "is_near"),
        [
            ("/robot/odometry/filterd", True),
            ("/odometry/Filterd", True),
            ("/wheel/ticks", False),
            ("/odometry/start", False),
            ("/x", False),
        ],
    )
    def test_near_is_another_namespace_or_a_slip(self, other, is_near):
        text = self.MISSPELT.replace("/odometry/filtered", other)
        assert bool(found("unmatched_topic", small_graph(text))) is is_near
        assert bool(found("incomplete_launch", small_graph(text))) is not is_near

    @pytest.mark.parametrize(
        ("expected", "sent", "more", "is_near"),
        [
            ("/imu", "/imu/data", "", True),
            ("/imu/data", "/imu", "", True),
            ("/imu", "/imus/data", "", False),
            ("/imu", "/imu/data", "/log log own\n sub /imu/data {}\n", False),
            ("/imu", "/imu/left", "/right driver own\n pub /imu/right {}\n", False),
        ],
    )
    def test_a_measurement_below_that_nobody_reads_is_near(self, expected, sent, more, is_near):
        type = "sensor_msgs/msg/Imu"
        text = f"/driver driver own\n pub {sent} {type}\n/ekf ekf own\n sub {expected} {type}\n"
        graph = small_graph(text + more.format(type))
        likely = [each.certainty is Certainty.LIKELY for each in found("unmatched_topic", graph)]
        assert likely == [True] * is_near
        states = text.replace(type, "std_msgs/msg/Bool")
        assert not found("unmatched_topic", small_graph(states))
        reader = Endpoint(node="/log", topic="/imu{?}", type=type, direction=Direction.SUBSCRIBE)
        maybe_read = replace(graph, endpoints=(*graph.endpoints, reader))
        assert not found("unmatched_topic", maybe_read)

    def test_among_very_many_names_a_near_one_tells_nothing(self):
        text = self.MISSPELT + "".join(
            f"/ekf{i} ekf own\n pub /odometry/{i} nav_msgs/msg/Odometry\n" for i in range(200)
        )
        assert not found("unmatched_topic", small_graph(text))

    def test_a_long_namespace_makes_no_name_near(self):
        text = self.MISSPELT.replace("/odometry/filtered", "/a_long_namespace/started")
        text = text.replace("/odometry/filterd", "/a_long_namespace/finished")
        assert not found("unmatched_topic", small_graph(text))

    def test_what_the_reader_itself_publishes_is_not_what_it_waits_for(self):
        text = self.MISSPELT.replace("/ekf ekf own\n", "/nav nav own\n")
        assert not found("unmatched_topic", small_graph(text))

    def test_logs_are_left_out(self):
        text = "/log log own\n sub /rosout rosgraph_msgs/Log\n"
        assert not found("unmatched_topic", small_graph(text))

    def test_what_only_a_viewer_reads_does_not_count(self):
        text = self.MISSPELT.replace("/nav nav ", "/nav rviz2 ")
        assert not found("unmatched_topic", small_graph(text))

    def test_commands_belong_to_open_command_or_to_lost_command(self):
        assert not found("unmatched_topic", small_graph(BASE))
        near = small_graph(BASE + f"/nav nav own\n pub /nav/cmd_vel {TWIST}\n")
        assert the_finding("lost_command", near).severity is Severity.MEDIUM
        assert not found("unmatched_topic", near)
        assert not found("open_command", near)

    @pytest.mark.parametrize(
        ("ros", "topic"),
        [(1, "/dock/feedback"), (1, "/dock/status"), (2, "/dock/_action/feedback")],
    )
    def test_topics_of_actions_are_left_out(self, ros, topic):
        text = f"/mission mission own\n sub {topic} a/B\n"
        client = Action(node="/mission", name="/dock", role=ActionRole.CLIENT)
        assert found("incomplete_launch", small_graph(text, ros=ros))
        graph = small_graph(text, ros=ros, actions=(client,))
        assert the_finding("incomplete_launch", graph).topics == ("/dock",)

    def test_other_topics_below_the_name_of_an_action_count(self):
        client = Action(node="/mission", name="/dock", role=ActionRole.CLIENT)
        text = "/mission mission own\n sub /dock/battery a/B\n"
        graph = small_graph(text, actions=(client,))
        assert the_finding("incomplete_launch", graph).topics == ("/dock/battery", "/dock")

    def test_a_name_that_is_known_in_part_is_left_out(self):
        graph = small_graph(self.MISSPELT)
        ends = tuple(
            replace(end, topic=end.topic.replace("/filterd", "/{?}")) for end in graph.endpoints
        )
        assert not found("unmatched_topic", replace(graph, endpoints=ends))

    @pytest.mark.parametrize(
        ("name", "may_be"),
        [
            ("/odometry/{?}", True),
            ("{?}", True),
            ("/{?}/filterd", True),
            ("/wheels/{?}", False),
            ("/odometry/{?}/raw", False),
        ],
    )
    def test_a_publisher_whose_name_is_known_in_part_may_be_the_missing_end(self, name, may_be):
        graph = small_graph(self.MISSPELT)
        end = Endpoint(
            node="/ekf", topic=name, direction=Direction.PUBLISH, resolution=Resolution.SYMBOLIC
        )
        graph = replace(graph, endpoints=(*graph.endpoints, end))
        likely = [each.certainty is Certainty.LIKELY for each in found("unmatched_topic", graph)]
        assert likely == ([] if may_be else [True])
        assert bool(found("incomplete_launch", graph)) is may_be

    def test_the_output_of_a_chain_is_not_joined_to_its_input(self):
        mux = f"/mux mux own\n    sub /cmd_vel_nav {TWIST}\n    pub /mixed {TWIST}\n"
        smoother = f"/smoother s own\n    sub /mixed {TWIST}\n    pub /cmd_vel {TWIST}\n"
        assert not found("unmatched_topic", small_graph(mux + smoother))
        apart = smoother.replace("/mixed", "/other") + f"/log log own\n    sub /cmd_vel {TWIST}\n"
        assert found("unmatched_topic", small_graph(mux + apart))[0].topics[1:] == ("/cmd_vel",)

    def test_no_reader_is_led_past_a_multiplexer(self):
        base = f"/base driver own\n    sub /cmd_vel_safe {TWIST}\n"
        nav = f"/nav nav own\n    pub /cmd_vel {TWIST}\n"
        mux = f"/mux mux own\n    sub /cmd_vel {TWIST}\n    pub /mixed {TWIST}\n"
        log = f"/log log own\n    sub /cmd_vel {TWIST}\n"
        assert found("unmatched_topic", small_graph(base + nav + log))
        assert not found("unmatched_topic", small_graph(base + nav + log + mux))


class TestNoServer:
    CALL = (ServiceClient(node="/slam", name="/map/save", type="a/srv/Save"),)

    @pytest.mark.parametrize(
        ("server", "is_near"),
        [
            (Service(node="/laser", name="/map/saved", type="a/srv/Save"), True),
            (Service(node="/laser", name="/map/saved"), True),
            (Service(node="/laser", name="/map/saved", type="a/srv/Other"), False),
            (Service(node="/laser", name="/map/saved", implicit=True), False),
            (Service(node="/laser", name="/map/{?}"), False),
            (Service(node="/laser", name="/other"), False),
        ],
    )
    def test_a_near_server_of_the_same_type_is_likely_meant(self, server, is_near):
        graph = small_graph(SCAN, clients=self.CALL, services=(server,))
        likely = [each.certainty is Certainty.LIKELY for each in found("no_server", graph)]
        assert likely == [True] * is_near
        assert bool(found("incomplete_launch", graph)) is not is_near

    def test_a_manager_that_asks_for_a_node_of_another_namespace(self):
        type = "lifecycle_msgs/srv/ChangeState"
        call = ServiceClient(node="/slam", name="/map_server/change_state", type=type)
        server = Service(
            node="/laser", name="/robot/map_server/change_state", type=type, implicit=True
        )
        finding = the_finding("no_server", small_graph(SCAN, clients=(call,), services=(server,)))
        assert finding.remedy == "did you mean /robot/map_server/change_state?"
        other = replace(server, name="/planner_server/change_state")
        call = replace(call, name="/smoother_server/change_state")
        assert not found("no_server", small_graph(SCAN, clients=(call,), services=(other,)))

    @pytest.mark.parametrize(
        ("node", "type", "is_told"),
        [
            ("/laser", "a/srv/Save", True),
            ("/other", "lifecycle_msgs/srv/GetState", True),
            ("/other", "a/srv/Save", False),
            ("/nobody", "lifecycle_msgs/srv/GetState", False),
        ],
    )
    def test_a_service_below_a_node_that_does_not_offer_it(self, node, type, is_told):
        text = "/laser driver own\n/slam slam own\n/other other third_party\n"
        call = ServiceClient(node="/slam", name=f"{node}/go", type=type)
        graph = small_graph(text, clients=(call,))
        told = [finding.cause for finding in found("no_server", graph)]
        assert told == [f"{node} is here and does not offer it"] * is_told
        assert bool(found("incomplete_launch", graph)) is not is_told
        unread = small_graph(text, clients=(call,), unread=(node,))
        assert not found("no_server", unread)

    def test_with_something_unread_it_is_possible_only(self):
        server = Service(node="/laser", name="/map/saved")
        for more in (
            {"unread": ("/firmware",)},
            {"unresolved": (UnresolvedItem(what="include x", why="?", hides=HiddenPart.NODES),)},
            {"services": (server, Service(node="/laser", name="{?}"))},
        ):
            keys = {"clients": self.CALL, "services": (server,)} | more
            finding = the_finding("no_server", small_graph(SCAN + FIRMWARE, **keys))
            assert finding.certainty is Certainty.POSSIBLE
            assert finding.remedy == "did you mean /map/saved?"

    def test_what_is_served_implicit_or_known_in_part_is_no_finding(self):
        served = Service(node="/laser", name="/map/save")
        assert not found("no_server", small_graph(SCAN, clients=self.CALL, services=(served,)))
        for change in ({"implicit": True}, {"name": "/{?}/save"}, {"node": "/rviz"}):
            clients = (replace(self.CALL[0], **change),)
            graph = small_graph(SCAN + "/rviz rviz2 own\n", clients=clients)
            assert not found("no_server", graph)

    def test_an_action(self):
        text = (
            "/mission mission own\n client /navigate_to_pos nav2_msgs/action/NavigateToPose\n"
            "/bt bt own\n server /navigate_to_pose nav2_msgs/action/NavigateToPose\n"
        )
        finding = the_finding("no_server", small_graph(text, ros=1))
        assert finding.summary == "/mission calls the action /navigate_to_pos, which nobody offers"
        assert finding.remedy == "did you mean /navigate_to_pose?"
        assert finding.certainty is Certainty.LIKELY
        correct = text.replace("to_pos ", "to_pose ")
        assert not found("no_server", small_graph(correct, ros=1))

    @pytest.mark.parametrize(
        ("served", "more", "is_meant"),
        [
            ("/arm/follow", "", True),
            ("/b1_arm/follow", "", False),
            ("/gripper_controller/follow", "", False),
            ("/trajectory_controller/follow", "", True),
            ("/arm/follow", "/third third own\n server /other/follow c/action/Follow\n", False),
            ("/arm/follow", "/third third own\n client /other/follow c/action/Follow\n", False),
            ("/arm/follow", "/third third own\n client /arm/follow c/action/Follow\n", False),
        ],
    )
    def test_the_only_action_of_a_type_is_likely_meant(self, served, more, is_meant):
        text = f"/paint paint own\n client /b2_arm/follow c/action/Follow\n{more}"
        text += f"/host host own\n server {served} c/action/Follow\n pub /states a_msgs/msg/B\n"
        found_now = found("no_server", small_graph(text))
        expected = [f"did you mean {served}?"] * is_meant
        assert [each.remedy for each in found_now if "b2" in each.subject] == expected
        service = (Service(node="/laser", name="/map/keep", type="a/srv/Save"),)
        assert not found("no_server", small_graph(SCAN, clients=self.CALL, services=service))

    def test_an_action_whose_name_is_known_in_part_is_no_other(self):
        client = Action(
            node="/paint", name="/arm/follow", type="c/action/Follow", role=ActionRole.CLIENT
        )
        server = replace(client, node="/host", name="/{?}", role=ActionRole.SERVER)
        assert not found("no_server", small_graph(SCAN, actions=(client, server)))

    def test_a_service_does_not_serve_an_action(self):
        client = Action(node="/slam", name="/map/save", role=ActionRole.CLIENT)
        service = Service(node="/laser", name="/map/save")
        graph = small_graph(SCAN, actions=(client,), services=(service,))
        assert the_finding("incomplete_launch", graph).topics == ("/map/save",)

    def test_a_service_and_an_action_of_one_name_are_one_finding(self):
        client = Action(node="/laser", name="/map/save", role=ActionRole.CLIENT)
        near = Service(node="/laser", name="/map/saved")
        graph = small_graph(SCAN, clients=self.CALL, actions=(client,), services=(near,))
        assert the_finding("no_server", graph).summary == (
            "/laser and /slam call the action and service /map/save, which nobody offers"
        )


class TestIncompleteLaunch:
    CALLS = (ServiceClient(node="/nav", name="/save"), ServiceClient(node="/nav", name="/load"))
    NAV = "/nav nav own\n    sub /odom nav_msgs/msg/Odometry\n    sub /zones a_msgs/msg/Zones\n"

    def test_one_finding_names_all_that_is_missing(self):
        finding = the_finding("incomplete_launch", small_graph(self.NAV, clients=self.CALLS))
        assert finding.summary == "/nav needs what this launch does not start"
        assert finding.cause == (
            "no node of this launch publishes /odom and /zones or offers /load and /save"
        )
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)
        assert finding.topics == ("/odom", "/zones", "/load", "/save")

    def test_what_was_not_read_may_be_what_is_missing(self):
        graph = small_graph(self.NAV + FIRMWARE, unread=("/firmware",))
        cause = the_finding("incomplete_launch", graph).cause
        assert cause.endswith("/zones, unless /firmware (not read) does")

    @pytest.mark.parametrize(
        ("type", "counts"),
        [
            ("sensor_msgs/msg/LaserScan", True),
            ("sensor_msgs/msg/JointState", True),
            ("nav_msgs/msg/OccupancyGrid", True),
            ("sensor_msgs/msg/JoyFeedback", False),
            ("nav2_msgs/msg/SpeedLimit", False),
            ("geometry_msgs/msg/PoseWithCovarianceStamped", False),
        ],
    )
    def test_other_inputs_of_nodes_from_elsewhere_are_options(self, type, counts):
        text = f"/driver driver third_party\n    sub /in {type}\n"
        assert bool(found("incomplete_launch", small_graph(text))) is counts
        own = text.replace("third_party", "own")
        assert found("incomplete_launch", small_graph(own))

    def test_commands_of_motion_are_left_to_open_command(self):
        assert not found("incomplete_launch", small_graph(BASE))


class TestSimTime:
    @pytest.mark.parametrize(
        ("values", "nodes", "value"),
        [
            ({"a": True, "b": True, "z": False}, ("/z",), "false"),
            ({"a": False, "b": True, "z": True}, ("/a",), "false"),
            ({"a": False, "b": False, "z": True}, ("/z",), "true"),
            ({"a": False, "z": True}, ("/a",), "false"),
            ({"a": True, "z": False}, ("/a",), "true"),
        ],
        ids=["last", "first", "true", "tie", "tie of true"],
    )
    def test_the_fewer_are_named_and_at_a_tie_the_first(self, values, nodes, value):
        finding = the_finding(
            "sim_time", small_graph(SCAN, parameters=parameters("use_sim_time", **values))
        )
        other = "true" if value == "false" else "false"
        assert finding.nodes == nodes
        assert finding.summary == f"{nodes[0]} lives in another time than the other nodes"
        assert finding.cause == f"use_sim_time is {value} there, {other} elsewhere"

    @pytest.mark.parametrize(
        "values",
        [
            {},
            {"laser": True},
            {"laser": False, "slam": False},
            {"laser": True, "slam": None},
            {"laser": True, "slam": 0},
            {"laser": True, "slam": "false"},
            {"laser": True, "rviz": False},
            {"laser": True, "_ros2cli_7": False},
        ],
    )
    def test_one_value_unknown_values_and_viewers_are_no_finding(self, values):
        text = SCAN + "/rviz rviz2 own\n"
        graph = small_graph(text, parameters=parameters("use_sim_time", **values))
        assert not found("sim_time", graph)

    @pytest.mark.parametrize(
        ("node", "package", "is_found"),
        [
            ("/sim", "ros_gz_sim", False),
            ("/image_bridge", "ros_gz_image", False),
            ("/gazebo", "gazebo_ros", False),
            ("/bt_navigator_navigate_to_pose_rclcpp_node", "nav2_bt_navigator", False),
            ("/global_costmap/global_costmap", "nav2_controller", False),
            ("/robot/local_costmap/local_costmap", "nav2_controller", False),
            ("/global_costmap/local_costmap", "nav2_controller", True),
            ("/controller_server", "nav2_controller", True),
            ("/my_rclcpp_node", "my_nav2_package", True),
        ],
    )
    def test_who_makes_the_time_or_gets_it_from_its_server_does_not_count(
        self, node, package, is_found
    ):
        values = parameters("use_sim_time", laser=True, slam=True)
        values += (NodeParameter(node=node, name="use_sim_time", value=False),)
        graph = small_graph(f"{SCAN}{node} {package} own\n", parameters=values)
        assert bool(found("sim_time", graph)) is is_found

    @pytest.mark.parametrize(
        ("package", "program", "is_found"),
        [
            ("controller_manager", "spawner", False),
            ("controller_manager", "ros2_control_node", True),
            ("tf2_ros", "static_transform_publisher", False),
        ],
    )
    def test_a_spawner_ends_at_once_and_a_static_transform_holds_at_any_time(
        self, package, program, is_found
    ):
        values = parameters("use_sim_time", laser=True, slam=True, other=False)
        graph = small_graph(SCAN, parameters=values)
        other = Node(name="/other", package=package, executable=program)
        graph = replace(graph, nodes=(*graph.nodes, other))
        assert bool(found("sim_time", graph)) is is_found


def test_a_parameter_file_without_ros__parameters_reaches_no_node():
    kind, file = "malformed_parameter_file", "/ws/src/base/config/base.yaml"
    finding = the_finding("unread_parameter", with_fact(kind, file, "", "/base"))
    assert finding.id == "unread_parameter:base/config/base.yaml"
    assert finding.summary == "the parameters in base/config/base.yaml reach no node"
    assert finding.cause.startswith("/base gets the file, which has no ros__parameters")
    assert (finding.level, finding.nodes) == (FindingLevel.REGULAR, ("/base",))


def test_an_unread_parameter_with_no_near_name_is_only_possible():
    finding = the_finding("unread_parameter", with_fact("unread_parameter", "/base", "gain"))
    assert finding.level is FindingLevel.PEDANTIC
    assert finding.remedy == "remove them, or declare them in the node"


class TestMissingProgram:
    def graph(self, *places, what="node /slam", missing="slam/slam", nearest=""):
        note = UnresolvedItem(what=what, why="gone", missing=missing, nearest=nearest)
        notes = (replace(note, evidence=(place,)) for place in places)
        nodes = (Node(name="/slam", package="slam", executable="slam"),)
        return replace(small_graph("", unresolved=tuple(notes)), nodes=nodes)

    def test_tells_the_node_and_the_program(self):
        places = tuple(Evidence(file=f"{name}.launch.py", line=1) for name in "ab")
        finding = the_finding("missing_program", self.graph(*places))
        assert finding.id == "missing_program:/slam"
        assert finding.summary == "/slam does not start"
        assert finding.cause == "no build file of its package makes or installs slam/slam"
        assert finding.evidence == places

    def test_tells_the_nearest_program(self):
        graph = self.graph(Evidence(file="a"), nearest="did you mean slam_node?")
        remedy = the_finding("missing_program", graph).remedy
        assert remedy.endswith("build and install the program; did you mean slam_node?")

    def test_the_nodes_of_one_program_are_one_finding(self):
        graph = self.graph(Evidence(file="a", line=1), Evidence(file="a", line=2))
        twin = replace(graph.nodes[0], name="/twin")
        finding = the_finding("missing_program", replace(graph, nodes=(*graph.nodes, twin)))
        assert finding.summary == "/slam and /twin do not start"
        assert finding.nodes == ("/slam", "/twin")

    @pytest.mark.parametrize("name", ["base/launch/joy.launch.py", "base/config/joy.yaml"])
    def test_a_file_that_is_not_there(self, name):
        place = Evidence(file="a.launch.py", line=18)
        graph = self.graph(place, place, what="include", missing=f"/ws/src/{name}")
        finding = the_finding("missing_program", graph)
        assert finding.subject == name
        file = name.rpartition("/")[2]
        assert finding.summary == f"the launch ends, or leaves out what {file} starts or sets"
        assert finding.cause == f"it names {name}, which is not there"
        assert finding.evidence == (place,)

    def test_files_of_one_name_in_two_packages_are_two(self):
        one, other = (
            self.graph(Evidence(file="a"), missing=f"/ws/{name}/launch/bringup.launch")
            for name in "pq"
        )
        both = replace(one, unresolved=(*one.unresolved, *other.unresolved))
        assert len(found("missing_program", both)) == 2


class TestMissingManagedNode:
    CALLS = tuple(
        ServiceClient(node="/manager", name=f"/{name}/{service}")
        for name in ("amcl", "recoveries")
        for service in ("change_state", "get_state")
    )
    AMCL = "/amcl nav2_amcl third_party\n"

    def offers(self, *names):
        return tuple(Service(node=name, name=f"{name}/change_state") for name in names)

    def test_where_another_of_its_nodes_is_there_it_is_likely(self):
        services = self.offers("/amcl", "/behaviors")
        graph = small_graph(MANAGER + self.AMCL, clients=self.CALLS, services=services)
        finding = the_finding("missing_managed_node", graph)
        assert finding.summary == "/manager waits for /recoveries and activates none of its nodes"
        assert finding.cause == "no node of this launch has this name; /behaviors has no manager"
        assert finding.remedy == "start /recoveries, or remove it from node_names"
        assert (finding.certainty, finding.level) == (Certainty.LIKELY, FindingLevel.REGULAR)
        assert not found("no_server", graph)
        assert not found("incomplete_launch", graph)

    def test_a_lifecycle_node_of_a_near_name_is_likely_meant(self):
        services = self.offers("/robot/amcl", "/robot/recoveries")
        graph = small_graph(MANAGER, clients=self.CALLS, services=services)
        finding = the_finding("missing_managed_node", graph)
        assert finding.remedy.startswith("did you mean /robot/amcl? Else start /amcl and /recover")
        assert finding.cause.endswith("; /robot/amcl and /robot/recoveries have no manager")
        assert finding.certainty is Certainty.LIKELY

    @pytest.mark.parametrize(
        ("text", "more"),
        [
            ("", {}),
            (AMCL + FIRMWARE, {"unread": ("/firmware",)}),
            (AMCL + "/{?} nav own\n", {}),
        ],
    )
    def test_where_another_launch_may_start_it_it_is_possible(self, text, more):
        finding = the_finding(
            "missing_managed_node", small_graph(MANAGER + text, clients=self.CALLS, **more)
        )
        assert (finding.certainty, finding.level) == (Certainty.POSSIBLE, FindingLevel.PEDANTIC)

    SLAM = small_graph(
        MANAGER + "/laser laser own\n/slam slam_toolbox third_party\n",
        clients=(ServiceClient(node="/manager", name="/laser/change_state"),),
        services=(
            Service(node="/laser", name="/laser/change_state"),
            Service(node="/slam", name="/slam/change_state"),
        ),
    )

    def test_a_lifecycle_node_that_no_manager_lists(self):
        finding = the_finding("missing_managed_node", self.SLAM)
        assert finding.summary == "nobody configures and activates /slam"
        assert finding.cause == "the node_names of /manager are /laser"
        assert finding.level is FindingLevel.REGULAR

    @pytest.mark.parametrize(
        "more",
        [
            {"clients": (ServiceClient(node="/slam", name="/slam/change_state"),)},
            {"wiring": (WiringFact(kind=WiringFactKind.TRANSITION, subject="a.launch.py"),)},
            {"unresolved": (UnresolvedItem(what="include x", why="?", hides=HiddenPart.NODES),)},
            {"services": (Service(node="/laser", name="/map/change_state"),)},
        ],
    )
    def test_a_lifecycle_node_that_something_else_may_activate(self, more):
        added = {key: (*getattr(self.SLAM, key), *values) for key, values in more.items()}
        added |= {"services": more["services"]} if "services" in more else {}
        assert not found("missing_managed_node", replace(self.SLAM, **added))

    @pytest.mark.parametrize(("event", "count"), [("slam", 0), ("laser", 1)])
    def test_an_event_activates_the_node_that_it_is_for(self, event, count):
        fact = WiringFact(kind=WiringFactKind.TRANSITION, subject="a.launch.py", value=event)
        graph = replace(self.SLAM, wiring=(fact,))
        assert len(found("missing_managed_node", graph)) == count

    ALONE = "/slam slam_toolbox third_party\n  pub /map nav_msgs/OccupancyGrid\n/planner nav own\n"

    def test_without_a_manager_a_node_that_others_read_is_to_be_activated(self):
        reader, services = "  sub /map nav_msgs/OccupancyGrid\n", self.offers("/slam")
        graph = small_graph(self.ALONE + reader, services=services)
        finding = the_finding("missing_managed_node", graph)
        assert finding.summary == "nobody configures and activates /slam"
        assert finding.cause.startswith("this launch has no lifecycle manager")
        assert finding.level is FindingLevel.REGULAR
        assert not found("missing_managed_node", small_graph(self.ALONE, services=services))

    @pytest.mark.parametrize(
        "more",
        [
            {"clients": (ServiceClient(node="/planner", name="/slam/change_state"),)},
            {"clients": (ServiceClient(node="/planner", name="/{?}/change_state"),)},
            {"unresolved": (UnresolvedItem(what="process all.sh", why="not looked into"),)},
        ],
    )
    def test_without_a_manager_whatever_is_not_seen_may_activate(self, more):
        text = self.ALONE + "  sub /map nav_msgs/OccupancyGrid\n"
        graph = replace(small_graph(text, services=self.offers("/slam")), **more)
        assert not found("missing_managed_node", graph)

    @pytest.mark.parametrize(
        ("cause", "count"),
        [
            (UnresolvedCause.ARGUMENT, 1),
            (UnresolvedCause.UNSET_VARIABLE, 1),
            (UnresolvedCause.MISSING_CODE, 0),
            (UnresolvedCause.PARTLY_READ, 0),
        ],
    )
    def test_without_a_manager_a_value_that_is_not_known_activates_nothing(self, cause, count):
        text = self.ALONE + "  sub /map nav_msgs/OccupancyGrid\n"
        note = UnresolvedItem(what="speed", why="?", cause=cause)
        graph = small_graph(text, services=self.offers("/slam"), unresolved=(note,))
        assert len(found("missing_managed_node", graph)) == count

    @pytest.mark.parametrize(("file", "count"), [("slam.py", 0), ("slam.cpp", 1)])
    def test_a_publisher_of_rclpy_needs_no_activation(self, file, count):
        text = self.ALONE + "  sub /map nav_msgs/OccupancyGrid\n"
        graph = small_graph(text, services=self.offers("/slam"))
        places = (Evidence(file=file, line=1),)
        ends = tuple(replace(each, evidence=places) for each in graph.endpoints)
        assert len(found("missing_managed_node", replace(graph, endpoints=ends))) == count

    def test_nodes_that_are_there_and_names_known_in_part_are_none(self):
        calls = (ServiceClient(node="/manager", name="/{?}/change_state"), *self.CALLS)
        text = MANAGER + self.AMCL + "/recoveries nav own\n"
        assert not found("missing_managed_node", small_graph(text, clients=calls))


class TestOverriddenParameter:
    def test_tells_both_values(self):
        graph = with_fact("overridden_parameter", "/use_sim_time", "False", "True", "$(arg sim)")
        finding = the_finding("unread_parameter", graph)
        expected = "/use_sim_time is False, although the launch sets it to True"
        assert (finding.summary, finding.level) == (expected, FindingLevel.REGULAR)
        assert "the default of its $(arg sim)" in finding.cause

    def test_a_value_of_its_own_may_be_meant_to_come_last(self):
        graph = with_fact("overridden_parameter", "/max_speed", "2.0", "1.0")
        assert the_finding("unread_parameter", graph).level is FindingLevel.PEDANTIC


class TestMissingPlugin:
    def test_tells_what_the_server_has(self):
        graph = with_fact("missing_plugin", "/r/planner_id/Grid", "/r/planner", "Smac", "Straight")
        finding = the_finding("missing_plugin", graph)
        assert finding.summary == "planner_id Grid is asked for, which /r/planner does not have"
        assert finding.cause == "of this kind it has Smac and Straight alone"
        assert finding.level is FindingLevel.REGULAR


class TestBypassedNode:
    def test_tells_who_reads_past_whom(self):
        finding = the_finding("bypassed_node", small_graph(FILTERED.format("/scan")))
        assert finding.summary == "/slam reads /scan past /filter"
        assert finding.cause == "/filter makes /scan_filtered of it, which nobody subscribes"
        assert finding.topics == ("/scan_filtered", "/scan")
        assert finding.level is FindingLevel.PEDANTIC

    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ("pub /scan_filtered sensor", "pub /scan_filtered other"),
            ("pub /scan_filtered", "pub /filter/scan"),
            ("pub /scan sensor", "pub /other sensor"),
            ("sub /scan_filtered", "sub /other"),
            ("pub /scan_filtered", "pub /cleaned"),
            ("pub /scan_filtered", "pub /{scan_filtered,scan_more}"),
        ],
    )
    def test_another_type_a_name_of_its_own_and_a_reader_less_do_not_count(self, old, new):
        text = FILTERED.format("/scan").replace(old, new)
        reader = "sub /scan_filtered" if old.startswith("sub") else "sub /scan"
        text = text.replace("/slam slam own\n    sub /scan", f"/slam slam own\n    {reader}")
        assert not found("bypassed_node", small_graph(text))

    def test_a_viewer_reads_past_nobody(self):
        text = FILTERED.format("/scan").replace("/slam slam own", "/rviz rviz2 third_party")
        assert not found("bypassed_node", small_graph(text))


class TestSharedOutput:
    @pytest.mark.parametrize("topic", ["/cmd_vel", "/diagnostics", "/tf", "/rosout", "/rover/bond"])
    def test_motion_and_what_all_share_do_not_count(self, topic):
        assert not found("shared_output", with_fact("shared_output", topic, "", "/a", "/b"))

    def test_a_second_map_is_regular(self):
        finding = the_finding("shared_output", with_fact("second_source", "/map", "", "/a", "/b"))
        assert finding.summary == "/a and /b both publish /map"
        assert finding.level is FindingLevel.REGULAR


UNDECIDED = "conditions that are not known decide which do"


def frame_facts(*facts):
    """Return a graph with facts about the frame `laser`: kind, parent and nodes of each."""
    wiring = tuple(
        WiringFact(kind=WiringFactKind(kind), subject="laser", value=parent, others=nodes)
        for kind, parent, *nodes in facts
    )
    return small_graph(SCAN, wiring=wiring)


@pytest.mark.parametrize("others", [(), ("arm", "base")])
def test_a_controller_without_a_type(others):
    graph = with_fact("untyped_controller", "/arms", "/spawner_arms", *others)
    finding = the_finding("missing_program", graph)
    assert finding.summary == "/spawner_arms cannot load the controller /arms"
    assert ("did you mean arm?" in finding.remedy) is bool(others)
    assert finding.level is FindingLevel.REGULAR


@pytest.mark.parametrize(
    ("meant", "said"), [("/odom", "in the wrong direction"), ("/m/odom", "does not have")]
)
def test_a_bridge_past_its_plugin_or_the_other_way(meant, said):
    finding = the_finding(
        "bridge_mismatch", with_fact("bridge_mismatch", "/odom", meant, "/bridge")
    )
    assert finding.summary.startswith("/bridge connects Gazebo's /odom")
    assert said in finding.summary
    assert finding.level is FindingLevel.REGULAR


@pytest.mark.parametrize(
    ("kind", "before", "said", "level"),
    [
        ("leaked_argument", "/l/front.xml", "front.xml", FindingLevel.REGULAR),
        ("possible_leaked_argument", "/l/rear.xml", "its inclusion before", FindingLevel.PEDANTIC),
    ],
)
def test_an_argument_of_a_file_before(kind, before, said, level):
    graph = with_fact(kind, "topic", "front/scan", "/l/rear.xml", before, "rear/scan")
    finding = the_finding("leaked_argument", graph)
    assert (finding.subject, finding.level) == ("rear.xml:topic", level)
    assert finding.summary == f"rear.xml gets topic from {said}"
    assert f"topic is front/scan since {said}, and not rear/scan" in finding.cause


def test_a_deadline_that_a_timer_does_not_hold():
    finding = the_finding("qos_mismatch", with_fact("slow_publisher", "/scan", "/l", "0.1", "0.5"))
    assert finding.summary == "/l does not hold the deadline that it offers on /scan"
    assert finding.cause == "the deadline is 0.1 s, and its timer sends every 0.5 s"
    assert finding.level is FindingLevel.REGULAR


def test_an_argument_that_a_file_does_not_know():
    missing = with_fact("missing_argument", "ns", "/l/state.launch.py")
    finding = the_finding("undeclared_argument", missing)
    assert finding.summary == "state.launch.py uses the argument ns, which nobody gives"
    assert finding.level is FindingLevel.REGULAR
    graph = with_fact("undeclared_argument", "file", "map_file", "/l/map.xml")
    finding = the_finding("undeclared_argument", graph)
    assert (finding.subject, finding.level) == ("map.xml:file", FindingLevel.REGULAR)
    assert finding.cause == "launch drops it, and map_file of map.xml keeps its default"


def test_a_loop_of_frames_is_one_finding_with_all_of_them():
    kind = WiringFactKind.FRAME_LOOP
    facts = tuple(
        WiringFact(kind=kind, subject="base", value=frame, others=(node,))
        for frame, node in (("base", "/ekf"), ("odom", "/driver"))
    )
    finding = the_finding("frame_loop", small_graph(SCAN, wiring=facts))
    assert finding.summary == "the transforms of base and odom form a loop"
    assert finding.cause == "each frame is below the other; /ekf and /driver broadcast them"
    assert (finding.nodes, finding.level) == (("/ekf", "/driver"), FindingLevel.REGULAR)


class TestDoubleFrame:
    def test_different_parents_are_likely_a_failure(self):
        graph = frame_facts(("double_frame", "base", "/a"), ("double_frame", "mast", "/b"))
        finding = the_finding("double_frame", graph)
        assert finding.summary == "/a and /b both broadcast the frame laser"
        assert finding.cause == "its parents are base and mast"
        assert finding.remedy == "let one node broadcast laser"
        assert finding.nodes == ("/a", "/b")
        assert (finding.certainty, finding.severity) == (Certainty.LIKELY, Severity.MEDIUM)
        assert finding.level is FindingLevel.REGULAR

    @pytest.mark.parametrize(
        ("kind", "parent", "level", "cause"),
        [
            ("double_frame", "base", "regular", "each sends a pose of its own below base"),
            ("double_frame", "", "regular", "each sends a pose of its own"),
            (
                "double_fixed_frame",
                "base",
                "pedantic",
                "each sends a transform that never changes below base",
            ),
            (
                "possible_double_frame",
                "base",
                "pedantic",
                f"each sends a pose of its own below base; {UNDECIDED}",
            ),
        ],
    )
    def test_one_parent(self, kind, parent, level, cause):
        finding = the_finding("double_frame", frame_facts((kind, parent, "/a", "/b")))
        assert (finding.level, finding.cause) == (level, cause)

    def test_nodes_that_name_themselves_have_one_name(self):
        graph = frame_facts(("double_fixed_frame", "base", "/static_{id}", "/static_{id}"))
        finding = the_finding("double_frame", graph)
        assert finding.summary == "several /static_{id} broadcast the frame laser"

    def test_the_frames_of_the_same_nodes_are_one_finding(self):
        kind = WiringFactKind.DOUBLE_FRAME
        wiring = tuple(
            WiringFact(kind=kind, subject=frame, value="base", others=("/b", "/a"))
            for frame in ("arm", "wheel")
        )
        finding = the_finding("double_frame", small_graph(SCAN, wiring=wiring))
        assert finding.summary == "/a and /b both broadcast the frames arm and wheel"
        assert finding.cause == "each sends a pose of its own"
        assert finding.subject == "arm"

    def test_a_frame_is_one_finding_by_what_is_surest(self):
        facts = [
            (kind, "base", "/a", "/b")
            for kind in ("possible_double_frame", "double_fixed_frame", "double_frame")
        ]
        assert the_finding("double_frame", frame_facts(*facts)).level is FindingLevel.REGULAR


class TestIdleRemap:
    IMAGE = "sensor_msgs/msg/Image"
    WIRED = (
        f"/camera camera own\n    pub /roof {IMAGE}\n"
        f"/tracker tracker own\n    sub /left/points {IMAGE}\n"
    )

    def graph(self, source, target, *nodes, text=WIRED, kinds=("unused_remap",), **keys):
        facts = tuple(
            WiringFact(kind=WiringFactKind(kind), subject=source, value=target, others=others)
            for kind, others in zip(kinds, (nodes or ("/tracker",), ()), strict=False)
        )
        return small_graph(text, wiring=facts, **keys)

    def test_exchanged_ends(self):
        finding = the_finding("idle_remap", self.graph("/roof", "/left/points"))
        assert finding.summary == (
            "the remap of /roof to /left/points changes nothing: /tracker subscribes /left/points, "
            "which nobody publishes"
        )
        assert finding.cause == (
            "/camera publishes /roof, which nobody subscribes; "
            "no node that gets the remap uses its old name"
        )
        assert finding.remedy == "exchange its ends"
        assert (finding.certainty, finding.level) == (Certainty.LIKELY, FindingLevel.REGULAR)

    def test_exchanged_ends_at_the_publisher(self):
        finding = the_finding("idle_remap", self.graph("/left/points", "/roof", "/camera"))
        assert finding.summary.endswith("/camera publishes /roof, which nobody subscribes")
        assert finding.remedy == "exchange its ends"

    @pytest.mark.parametrize("source", ["/points", "/left/ponts", "/unlike"])
    def test_a_name_that_the_node_does_not_use(self, source):
        finding = the_finding("idle_remap", self.graph(source, "/roof"))
        assert finding.remedy == "remap /left/points instead"
        assert finding.topics == (source, "/roof", "/left/points")

    @pytest.mark.parametrize(
        "more",
        [
            f"/other camera own\n    pub /left/points {IMAGE}\n",
            f"/other tracker own\n    sub /roof {IMAGE}\n",
            f"/tracker tracker own\n    sub /right {IMAGE}\n    sub /rear {IMAGE}\n",
        ],
    )
    def test_topics_with_both_ends_and_a_choice_are_not_joined(self, more):
        source = "/unlike"
        assert found("idle_remap", self.graph(source, "/roof"))
        assert not found("idle_remap", self.graph(source, "/roof", text=self.WIRED + more))

    def test_of_several_topics_the_near_one_is_meant(self):
        more = f"/tracker tracker own\n    sub /right {self.IMAGE}\n"
        graph = self.graph("/points", "/roof", text=self.WIRED + more)
        assert the_finding("idle_remap", graph).remedy == "remap /left/points instead"

    def test_another_type_and_another_node_are_not_joined(self):
        text = self.WIRED.replace(f"/roof {self.IMAGE}", "/roof sensor_msgs/msg/Imu")
        assert not found("idle_remap", self.graph("/roof", "/left/points", text=text))
        assert not found("idle_remap", self.graph("/unlike", "/roof", "/camera"))

    def test_what_was_not_read_may_be_the_other_end(self):
        graph = self.graph(
            "/roof", "/left/points", text=self.WIRED + FIRMWARE, unread=("/firmware",)
        )
        assert not found("idle_remap", graph)

    @pytest.mark.parametrize(
        ("name", "direction", "is_joined"),
        [
            ("/left/{?}", Direction.PUBLISH, False),
            ("/roo{?}", Direction.SUBSCRIBE, False),
            ("/right/{?}", Direction.PUBLISH, True),
        ],
    )
    def test_a_name_known_in_part_may_be_either_end(self, name, direction, is_joined):
        end = Endpoint(node="/mix", topic=name, type=self.IMAGE, direction=direction)
        graph = self.graph("/roof", "/left/points")
        graph = replace(graph, endpoints=(*graph.endpoints, end))
        assert bool(found("idle_remap", graph)) is is_joined

    def test_that_nobody_uses_the_name_is_for_the_pedantic(self):
        kinds = ("unused_remap", "idle_remap")
        finding = the_finding("idle_remap", self.graph("/a", "/b", kinds=kinds))
        assert finding.level is FindingLevel.PEDANTIC
        assert finding.cause == "no node that gets it uses the name; their source was read whole"

    @pytest.mark.parametrize(
        ("source", "target", "level"),
        [
            ("/left/ponts", "/b", "regular"),
            ("/points", "/b", "regular"),
            ("/left/ponts", "/left/points", "pedantic"),  # it would change nothing either
            ("/roofs", "/b", "pedantic"),  # another node's
        ],
    )
    def test_a_near_name_that_lacks_its_other_end_is_meant(self, source, target, level):
        text = self.WIRED.replace(f"/roof {self.IMAGE}", "/roof sensor_msgs/msg/Imu")
        kinds = ("unused_remap", "idle_remap")
        finding = the_finding("idle_remap", self.graph(source, target, text=text, kinds=kinds))
        assert finding.level == level
        remedy = "did you mean /left/points? Else remove the remap"
        assert (finding.remedy == remedy) is (level == "regular")

    def test_a_near_name_with_both_ends_is_not_meant(self):
        more = f"/other camera own\n    pub /left/points {self.IMAGE}\n"
        kinds = ("unused_remap", "idle_remap")
        graph = self.graph("/points", "/b", text=self.WIRED + more, kinds=kinds)
        assert the_finding("idle_remap", graph).level is FindingLevel.PEDANTIC

    def test_a_remap_that_is_joined_is_one_finding(self):
        kinds = ("unused_remap", "idle_remap")
        assert the_finding("idle_remap", self.graph("/roof", "/left/points", kinds=kinds))

    @pytest.mark.parametrize("kind", ["unused_remap", "idle_remap"])
    def test_transforms_do_not_count(self, kind):
        text = self.WIRED.replace("/roof", "/tf")
        assert not found("idle_remap", self.graph("/tf", "/left/points", text=text, kinds=(kind,)))


class TestUnreachedListener:
    @pytest.mark.parametrize(
        ("sent", "level", "hint"),
        [
            ("/left/tf_static", "regular", "; /flange sends /left/tf_static"),
            ("/tf_static", "pedantic", ""),
        ],
    )
    def test_it_is_likely_where_a_node_sends_the_remapped_transforms(self, sent, level, hint):
        kind = WiringFactKind.UNREACHED_LISTENER
        facts = tuple(
            WiringFact(kind=kind, subject="/tool", value=f"/left/{name}", others=(f"/{name}",))
            for name in ("tf", "tf_static")
        )
        text = f"/flange tf2_ros own\n    pub {sent} tf2_msgs/msg/TFMessage\n"
        finding = the_finding("unreached_listener", small_graph(text, wiring=facts))
        assert finding.level == level
        assert finding.summary == (
            "the transform listener of /tool does not get /left/tf and /left/tf_static"
        )
        assert finding.cause.endswith(f"it subscribes /tf and /tf_static{hint}")


class TestDuplicateNode:
    def graph(self, *starts):
        """Return a graph with a fact for each node and the files that start it."""
        facts = [
            WiringFact(
                kind=WiringFactKind.DUPLICATE_NODE,
                subject=node,
                evidence=tuple(Evidence(file=file, line=line) for file in files),
            )
            for line, (node, *files) in enumerate(starts, 1)
        ]
        return small_graph(BASE, wiring=tuple(facts))

    def test_a_name_is_one_finding_with_all_its_places(self):
        graph = self.graph(("/a", "x", "y"), ("/b", "x", "y"), ("/a", "x", "z"))
        of_a, of_b = found("duplicate_node", graph)
        assert [of_a.subject, of_b.subject] == ["/a", "/b"]
        assert [(place.file, place.line) for place in of_a.evidence] == [
            ("x", 1),
            ("y", 1),
            ("x", 3),
            ("z", 3),
        ]

    def test_different_programs_are_named(self):
        (one,), (other,) = (self.graph(("/a", "x", "y")).wiring for _ in range(2))
        facts = (replace(one, others=("p/a",)), replace(other, others=("p/b",)))
        finding = the_finding("duplicate_node", small_graph(BASE, wiring=facts))
        assert finding.summary == "p/a and p/b both have the name /a"
        finding = the_finding("duplicate_node", small_graph(BASE, wiring=(facts[0],)))
        assert finding.summary == "/a starts more than once"

    def test_a_viewer_s_is_for_the_pedantic(self):
        graph = self.graph(("/rviz", "x", "y"), ("/a", "x", "y"))
        viewer = Node(name="/rviz", package="rviz2", executable="rviz2")
        graph = replace(graph, nodes=(*graph.nodes, viewer))
        levels = {each.subject: each.level for each in found("duplicate_node", graph)}
        assert levels == {"/a": FindingLevel.REGULAR, "/rviz": FindingLevel.PEDANTIC}

    def test_the_tool_s_nodes_do_not_count(self):
        assert not found("duplicate_node", self.graph(("/r/_ros2cli_requester_T", "x", "y")))


class TestMistypedParameter:
    def test_it_says_both_types(self):
        graph = with_fact("mistyped_parameter", "/base", "max_vel", "double", "integer")
        finding = the_finding("mistyped_parameter", graph)
        assert finding.summary == "/base does not start: the launch gives max_vel another type"
        assert finding.cause == "the node declares it as double, the launch gives it as integer"
        assert finding.remedy == "write the value as double, or declare integer in the node"
        assert (finding.subject, finding.level) == ("/base:max_vel", FindingLevel.REGULAR)


@pytest.mark.parametrize(
    ("one", "other", "near"),
    [
        ("/camera/scan", "/scan", True),
        ("/r/a/scan", "/a/scan", True),
        ("/a/scan", "/a/b/scan", True),
        ("/smoother/error", "/select/error", False),
        ("/smoother/error", "/smother/error", True),
        ("/data", "/data_compass", True),
        ("/data", "/database", False),
        ("/a", "/a", False),
    ],
)
def test_names_are_near_in_a_namespace_more_a_slip_or_with_more_words(one, other, near):
    assert is_near(one, other) is near
    assert is_near(other, one) is near


PARTNERS = (
    "/teleop own own\n    pub /arm/speed own/Arm\n/can own own\n    sub /arm/angles own/Arm\n"
)


def test_two_topics_that_alone_have_a_type_of_the_apps_own_may_be_one():
    finding = the_finding("unmatched_topic", small_graph(PARTNERS))
    assert finding.topics == ("/arm/angles", "/arm/speed")
    assert finding.remedy.startswith("find out who should publish /arm/angles")
    heard = "/gui own own\n    sub /arm/speed own/Arm\n"
    third = "/gui own own\n    pub /arm/third own/Arm\n"
    own = PARTNERS.replace("/can own own\n", "/can own own\n    pub /arm/speed own/Arm\n")
    for other in (
        PARTNERS + heard,
        PARTNERS + third,
        own.replace("/teleop own own\n    pub /arm/speed own/Arm\n", ""),
        PARTNERS.replace("own/Arm", "std_msgs/Float32"),
        PARTNERS.replace("/arm/speed", "/leg/speed"),
    ):
        assert not found("unmatched_topic", small_graph(other))
