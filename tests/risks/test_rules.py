"""What each rule counts and what it leaves out, where text and algorithm leave doubt."""

import gc
from dataclasses import replace

import pytest
from notation import graph_of

from rtron.risks import RULES, discover_risks
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Domain,
    Endpoint,
    Evidence,
    FunctionType,
    InteractionGraph,
    Node,
    RiskKind,
    RiskRole,
    Severity,
    Sharing,
    Topic,
    Trust,
)


def found(text: str, rule: str, **changes):
    report = discover_risks(replace(graph_of("app", text), **changes))
    return [risk for risk in report.risks if risk.rule == rule]


def topic_pair(topic: str, message_type: str) -> str:
    return f"/a a own\n pub {topic} {message_type}\n/b b own\n sub {topic} {message_type}\n"


def shared(topic: str, message_type: str, trust: str = "own", listener: str = "driver") -> str:
    ends = f"/a a own\n pub {topic} {message_type}\n/b b {trust}\n pub {topic} {message_type}\n"
    return ends + f"/c {listener} own\n sub {topic} {message_type}\n"


class TestSingleTopic:
    def test_tells_who_publishes_what_to_whom(self):
        (risk,) = found(shared("/cmd_vel", "geometry_msgs/Twist"), "gr_st")
        assert risk.id == "GR-ST:/cmd_vel"
        assert risk.role_nodes == {RiskRole.PUBLISHER: ("/a", "/b")}
        assert risk.topics == ("/cmd_vel",)
        assert risk.successors == ("/c",)
        assert risk.message_type == "geometry_msgs/Twist"
        assert risk.domain is Domain.CONTROL
        assert risk.reason == "/a and /b both publish /cmd_vel: /c follows whoever spoke last"

    def test_a_node_that_advertises_twice_is_one_publisher(self):
        assert not found(shared("/x", "p/T").replace("/b b", "/a b"), "gr_st")

    def test_a_publisher_may_be_its_own_successor(self):
        graph = graph_of("app", shared("/x", "p/T").replace("/c driver", "/a driver"))
        (risk,) = discover_risks(graph).risks
        assert risk.successors == ("/a",)

    @pytest.mark.parametrize("package", ["rviz", "rosbag", "rqt_graph", "rviz2", "ros2bag"])
    def test_whoever_only_looks_is_no_successor(self, package):
        assert not found(shared("/x", "p/T", listener=package), "gr_st")

    def test_a_viewer_is_known_by_its_package_not_by_its_name(self):
        assert found(shared("/x", "p/T").replace("/c ", "/rviz "), "gr_st")

    def test_a_viewer_counts_as_a_publisher(self):
        (risk,) = found(shared("/x", "p/T").replace("/b b", "/rviz rviz"), "gr_st")
        assert risk.role_nodes[RiskRole.PUBLISHER] == ("/a", "/rviz")

    @pytest.mark.parametrize(
        ("topic", "message_type"),
        [
            ("/rosout", "p/T"),
            ("/rosout_agg", "p/T"),
            ("/x", "rosgraph_msgs/Log"),
            ("/x", "rcl_interfaces/msg/Log"),
            ("/x", "visualization_msgs/MarkerArray"),
            ("/parameter_events", "rcl_interfaces/msg/ParameterEvent"),
        ],
    )
    def test_logs_and_visualisation_are_left_out(self, topic, message_type):
        assert not found(shared(topic, message_type), "gr_st")

    def test_a_merging_topic_is_told_in_its_own_words(self):
        (risk,) = found(shared("/tf", "tf2_msgs/TFMessage"), "gr_st")
        assert "overwrite" in risk.reason

    def test_many_publishers_are_shortened_in_the_reason_only(self):
        text = "".join(f"/n{i} n own\n pub /x p/T\n" for i in range(9))
        (risk,) = found(text + "/s s own\n sub /x p/T\n", "gr_st")
        assert "/n0, /n1, /n2 and 6 more all publish /x" in risk.reason
        assert len(risk.role_nodes[RiskRole.PUBLISHER]) == 9


class TestSeverity:
    @pytest.mark.parametrize(
        ("topic", "message_type", "trust", "severity"),
        [
            ("/cmd_vel", "geometry_msgs/Twist", "third_party", Severity.HIGH),
            ("/cmd_vel", "geometry_msgs/Twist", "unknown", Severity.HIGH),
            ("/cmd_vel", "geometry_msgs/Twist", "own", Severity.MEDIUM),
            ("/x/goal", "geometry_msgs/PoseStamped", "unknown", Severity.HIGH),
            ("/scan", "sensor_msgs/LaserScan", "unknown", Severity.MEDIUM),
            ("/scan", "sensor_msgs/LaserScan", "own", Severity.LOW),
            ("/tf", "tf2_msgs/TFMessage", "third_party", Severity.MEDIUM),
            ("/control/status", "std_msgs/String", "third_party", Severity.MEDIUM),
        ],
    )
    def test_of_a_shared_topic(self, topic, message_type, trust, severity):
        (risk,) = found(shared(topic, message_type, trust), "gr_st")
        assert risk.severity is severity

    @pytest.mark.parametrize(
        ("rule", "topic", "message_type", "own", "third_party"),
        [
            ("rsr_max_vel", "/max_vel", "std_msgs/Float64", Severity.MEDIUM, Severity.HIGH),
            ("msr_action", "/goal", "geometry_msgs/Pose", Severity.MEDIUM, Severity.HIGH),
            ("msr_event", "/odom", "nav_msgs/Odometry", Severity.LOW, Severity.MEDIUM),
        ],
    )
    def test_of_a_single_publisher(self, rule, topic, message_type, own, third_party):
        text = topic_pair(topic, message_type)
        assert found(text, rule)[0].severity is own
        assert found(text.replace("/a a own", "/a a third_party"), rule)[0].severity is third_party
        nobody = text.split("/b b own")[0]
        assert found(nobody.replace("own", "unknown"), rule)[0].severity is Severity.LOW

    def test_a_node_that_the_graph_does_not_list_is_not_trusted(self):
        (risk,) = found(shared("/cmd_vel", "geometry_msgs/Twist"), "gr_st", nodes=())
        assert risk.severity is Severity.HIGH


class TestMultipleTopics:
    def test_tells_what_a_node_hears(self):
        text = "/g g own\n pub /{left,right} p/T\n/n n own\n sub /{left,right} p/T\n"
        (risk,) = found(text, "gr_mt")
        assert risk.id == "GR-MT:/n:p/T"
        assert risk.topics == ("/left", "/right")
        assert risk.role_nodes == {RiskRole.PUBLISHER: ("/g",)}
        assert risk.successors == ("/n",)
        assert risk.one_to_one

    def test_more_publishers_or_subscribers_are_found_but_not_one_to_one(self):
        text = "/g g own\n pub /{left,right} p/T\n/n n own\n sub /{left,right} p/T\n"
        for more in ("/h h own\n pub /left p/T\n", "/h h own\n sub /left p/T\n"):
            (risk,) = found(text + more, "gr_mt")
            assert not risk.one_to_one

    def test_topics_that_nobody_publishes_count_but_are_mild(self):
        (risk,) = found("/n n own\n sub /{left,right} p/T\n", "gr_mt")
        assert risk.role_nodes == {RiskRole.PUBLISHER: ()}
        assert risk.severity is Severity.LOW
        assert "whoever publishes one" in risk.reason

    @pytest.mark.parametrize("other", ["geometry_msgs/msg/Twist", "geometry_msgs/TwistStamped"])
    def test_spelling_and_stamp_make_no_other_type(self, other):
        text = f"/n n own\n sub /left geometry_msgs/Twist\n sub /right {other}\n"
        (risk,) = found(text, "gr_mt")
        assert risk.message_type == "geometry_msgs/Twist"

    @pytest.mark.parametrize("package", ["rviz", "rosbag"])
    def test_whoever_only_looks_is_not_misled(self, package):
        assert not found(f"/n {package} own\n sub /{{left,right}} p/T\n", "gr_mt")

    def test_log_and_visualisation_topics_do_not_count(self):
        text = "/n n own\n sub /{a,b} visualization_msgs/Marker\n sub /{rosout,c} p/T\n"
        assert not found(text, "gr_mt")

    def test_two_subscriptions_of_one_topic_are_one(self):
        assert not found("/n n own\n sub /x p/T\n sub /x p/T\n", "gr_mt")

    def test_unknown_types_are_not_the_same_type(self):
        ends = [
            Endpoint(node="/n", topic=name, type=kind, direction=Direction.SUBSCRIBE)
            for name, kind in (("/a", ""), ("/b", ""), ("/c", "*"), ("/d", "*"), ("/e", "p/T"))
        ]
        assert discover_risks(InteractionGraph(app="app", endpoints=tuple(ends))).risks == ()

    def test_a_subscriber_of_any_type_takes_the_type_of_its_topic(self):
        text = "/n n own\n sub /left p/T\n sub /right *\n/g g own\n pub /right p/T\n"
        (risk,) = found(text, "gr_mt", topics=(Topic(name="/right", types=("p/msg/T", "p/T")),))
        assert risk.topics == ("/left", "/right")

    def test_the_domain_is_that_of_most_topics(self):
        text = "/n n own\n sub /detect/{a,b} std_msgs/Float64\n sub /max_vel std_msgs/Float64\n"
        assert found(text, "gr_mt")[0].domain is Domain.PERCEPTION
        assert found(text.replace("{a,b}", "a"), "gr_mt")[0].domain is Domain.CONTROL
        text = "/n n own\n sub /{detect,chatter} std_msgs/Float64\n"
        assert found(text, "gr_mt")[0].domain is Domain.PERCEPTION

    def test_one_topic_that_matters_makes_it_severe(self):
        text = "/g g third_party\n pub /goal p/T\n/n n own\n sub /{goal,other} p/T\n"
        assert found(text, "gr_mt")[0].severity is Severity.HIGH

    def test_a_crowd_of_publishers_is_named_in_part(self):
        text = "".join(f"/n{i} n own\n pub /x p/T\n" for i in range(200))
        (risk,) = found(text + "/s s own\n sub /{x,y} p/T\n", "gr_mt")
        assert len(risk.role_nodes[RiskRole.PUBLISHER]) == 100


class TestImage:
    TEXT = "/n n own\n sub /image sensor_msgs/Image\n pub {} std_msgs/UInt8\n"

    @pytest.mark.parametrize("topic", ["/detect/sign", "/people", "/faces", "/objects"])
    def test_the_recognition_is_known_by_its_name(self, topic):
        (risk,) = found(self.TEXT.format(topic), "rsr_image")
        assert risk.id == "RSR-image:/n"
        assert risk.role_nodes == {RiskRole.IMAGE: ("/n",)}
        assert risk.topics == (topic,)
        assert risk.message_type == "sensor_msgs/Image"

    def test_other_output_is_none(self):
        assert not found(self.TEXT.format("/lane"), "rsr_image")

    def test_a_detector_without_images_is_none(self):
        assert not found("/n n own\n pub /detect p/T\n sub /scan p/T\n", "rsr_image")

    def test_one_node_is_one_risk(self):
        text = self.TEXT.format("/{faces,people}").replace("/image", "/{left,right}")
        assert len(found(text, "rsr_image")) == 1


class TestMaxVel:
    def test_name_and_type_must_both_fit(self):
        assert found(topic_pair("/my_max_vel_now", "std_msgs/msg/Float64"), "rsr_max_vel")
        assert not found(topic_pair("/max_velocity", "std_msgs/Float32"), "rsr_max_vel")
        assert not found(topic_pair("/maximum", "std_msgs/Float64"), "rsr_max_vel")

    def test_one_type_that_fits_is_enough(self):
        text = topic_pair("/max_vel", "std_msgs/Float32").replace("Float32", "Float64", 1)
        assert found(text, "rsr_max_vel")

    def test_all_publishers_have_a_role(self):
        (risk,) = found(shared("/max_vel", "std_msgs/Float64"), "rsr_max_vel")
        assert risk.id == "RSR-max_vel:/max_vel"
        assert risk.role_nodes == {RiskRole.MAX_VEL: ("/a", "/b")}


class TestEvent:
    @pytest.mark.parametrize(
        "name",
        [
            "BatteryState",
            "Temperature",
            "RelativeHumidity",
            "MagneticField",
            "FluidPressure",
            "NavSatFix",
            "Illuminance",
        ],
    )
    def test_the_list_of_the_paper(self, name):
        assert found(topic_pair("/x", f"sensor_msgs/{name}"), "msr_event")
        assert found(topic_pair("/x", f"sensor_msgs/msg/{name}"), "msr_event")

    def test_a_detect_topic_counts_whatever_its_type(self):
        (risk,) = found(topic_pair("/detect/sign", "std_msgs/UInt8"), "msr_event")
        assert risk.id == "MSR-event:/detect/sign"
        assert risk.role_nodes == {RiskRole.EVENT: ("/a",)}

    @pytest.mark.parametrize(
        "type", ["Image", "CompressedImage", "LaserScan", "PointCloud2", "Imu"]
    )
    def test_own_preprocessing_is_left_out_where_it_hands_on_sensory_data(self, type):
        first = Node(name="/a", function=FunctionType.PREPROCESSING, trust=Trust.OWN)
        both = (first, Node(name="/b", function=FunctionType.RECOGNITION))
        text = "".join(f"/{n} {n} own\n pub /detect sensor_msgs/{type}\n" for n in "ab")
        assert found(text, "msr_event", nodes=both)[0].role_nodes == {RiskRole.EVENT: ("/b",)}
        assert not found(topic_pair("/detect", f"sensor_msgs/{type}"), "msr_event", nodes=(first,))

    @pytest.mark.parametrize(
        ("topic", "type", "trust"),
        [
            ("/detect", "sensor_msgs/Image", Trust.UNKNOWN),
            ("/detect", "sensor_msgs/Image", Trust.THIRD_PARTY),
            ("/detect", "std_msgs/UInt8", Trust.OWN),
            ("/odom", "nav_msgs/Odometry", Trust.OWN),
            ("/battery", "sensor_msgs/BatteryState", Trust.OWN),
        ],
    )
    def test_what_is_only_called_preprocessing_is_not(self, topic, type, trust):
        node = Node(name="/a", function=FunctionType.PREPROCESSING, trust=trust)
        [risk] = found(topic_pair(topic, type), "msr_event", nodes=(node,))
        assert risk.role_nodes == {RiskRole.EVENT: ("/a",)}


class TestAction:
    @pytest.mark.parametrize(
        "message_type",
        [
            "geometry_msgs/Twist",
            "geometry_msgs/msg/TwistStamped",
            "geometry_msg/Twist",
            "audio_common_msgs/AudioData",
            "audio_common_msg/AudioData",
            "control_msgs/FollowJointTrajectoryActionGoal",
        ],
    )
    def test_the_list_of_the_paper(self, message_type):
        assert found(topic_pair("/x", message_type), "msr_action")

    @pytest.mark.parametrize(
        "message_type",
        [
            "control_msgs/FollowJointTrajectoryActionFeedback",
            "control_msgs/FollowJointTrajectoryActionResult",
            "move_base_msgs/MoveBaseActionGoal",
            "geometry_msgs/TwistWithCovarianceStamped",
        ],
    )
    def test_answers_and_measurements_are_no_actions(self, message_type):
        assert not found(topic_pair("/x", message_type), "msr_action")

    @pytest.mark.parametrize("topic", ["/goal", "/move_base_simple/goal", "/current_goal_pose"])
    def test_a_goal_counts_whatever_its_type(self, topic):
        assert found(topic_pair(topic, "p/T"), "msr_action")[0].role_nodes == {
            RiskRole.ACTION: ("/a",)
        }

    @pytest.mark.parametrize(
        ("topic", "message_type"),
        [
            ("/goal_server/x", "p/DriveActionFeedback"),
            ("/goal_server/x", "p/DriveActionResult"),
            ("/goal_server/x", "p/action/Drive_FeedbackMessage"),
            ("/goal_server/result", "std_msgs/Bool"),
            ("/goal_server/feedback", "std_msgs/Bool"),
        ],
    )
    def test_answers_to_a_goal_are_none(self, topic, message_type):
        assert not found(topic_pair(topic, message_type), "msr_action")

    def test_an_action_of_ros_2_counts_itself(self):
        type_ = "control_msgs/action/FollowJointTrajectory"
        sides = tuple(
            Action(node=node, name="/arm", type=type_, role=role)
            for node, role in (("/c", ActionRole.CLIENT), ("/s", ActionRole.SERVER))
        )
        text = topic_pair("/x", "p/T")
        (risk,) = found(text, "msr_action", ros=2, actions=sides)
        assert risk.id == "MSR-action:/arm"
        assert risk.role_nodes == {RiskRole.ACTION: ("/c",)}
        assert risk.successors == ("/s",)
        assert risk.domain is Domain.CONTROL
        more = (replace(sides[0], node="/b"), *sides)
        assert found(text, "msr_action", ros=2, actions=more)[0].role_nodes == {
            RiskRole.ACTION: ("/b", "/c")
        }
        assert not found(text, "gr_st", ros=2, actions=sides)
        (shared,) = found(text, "gr_st", ros=2, actions=more)
        assert (shared.id, shared.topics, shared.successors) == ("GR-ST:/arm", ("/arm",), ("/s",))
        assert shared.role_nodes == {RiskRole.PUBLISHER: ("/b", "/c")}
        own = (*sides, replace(sides[0], node="/s"))
        assert not found(text, "gr_st", ros=2, actions=own)
        assert not found(text, "gr_st", ros=1, actions=more)
        assert not found(text, "msr_action", ros=2, actions=sides[1:])
        assert not found(text, "msr_action", ros=1, actions=sides)


class TestReport:
    def test_a_rule_that_cannot_run_finds_nothing_and_says_why(self):
        end = Endpoint(node="/a", topic="/detect/goal", direction=Direction.PUBLISH)
        report = discover_risks(InteractionGraph(app="app", endpoints=(end,)))
        assert report.risks == ()
        assert report.not_run["msr_event"] == "the graph holds no message types"
        assert report.not_run["gr_mt"] == "the graph holds no subscribers and no message types"
        assert set(report.not_run) == {rule.name for rule in RULES}

    def test_one_known_type_is_enough_to_run(self):
        text = "/a a own\n pub /detect p/T\n"
        assert found(text, "msr_event", topics=())
        untyped = tuple(replace(e, type="") for e in graph_of("app", text).endpoints)
        assert found(text, "msr_event", endpoints=untyped)

    @pytest.mark.parametrize("enabled", [True, False])
    def test_the_garbage_collector_is_left_as_it_was(self, enabled):
        was = gc.isenabled()
        (gc.enable if enabled else gc.disable)()
        discover_risks(InteractionGraph(app="app"))
        assert gc.isenabled() is enabled
        (gc.enable if was else gc.disable)()

    def test_evidence_is_that_of_the_endpoints(self):
        lines = [Evidence(file="a.cpp", line=line) for line in (1, 2, 1)]
        ends = [
            Endpoint(node=f"/{i}", topic="/x", direction=Direction.PUBLISH, evidence=(line,))
            for i, line in enumerate(lines)
        ]
        ends.append(Endpoint(node="/s", topic="/x", direction=Direction.SUBSCRIBE))
        (risk,) = discover_risks(InteractionGraph(app="app", endpoints=tuple(ends))).risks
        assert risk.evidence == tuple(lines[:2])

    def test_every_topic_of_a_risk_has_its_class(self):
        report = discover_risks(graph_of("app", shared("/tf", "tf2_msgs/TFMessage")))
        assert set(report.topic_classes) == {"/tf"}
        assert report.topic_classes["/tf"].sharing is Sharing.MERGE

    def test_coordination_nodes_are_counted_once_a_topic(self):
        text = shared("/cmd_vel", "geometry_msgs/Twist") + "/d d own\n sub /{cmd_vel,x} p/T\n"
        counted = discover_risks(graph_of("app", text)).coordination_nodes
        assert counted.grcn[Domain.CONTROL] == 1
        assert counted.grcn[Domain.OTHERS] == 1
        assert counted.grcn[Domain.PLANNING] == 0
        assert Domain.DRIVERS not in counted.grcn
        assert (counted.fps_monitor, counted.rsrcn, counted.msrcn) == (0, 0, 1)

    def test_ids_are_unique_and_kinds_come_in_order(self):
        report = discover_risks(graph_of("app", shared("/detect/goal", "geometry_msgs/Twist")))
        ids = [risk.id for risk in report.risks]
        assert len(ids) == len(set(ids))
        order = list(RiskKind)
        assert ids[0].startswith("GR-ST")
        assert [r.kind for r in report.risks] == sorted(
            (r.kind for r in report.risks), key=order.index
        )
