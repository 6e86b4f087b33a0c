"""The plan that risks ask for: its modes, policies, priorities and ends."""

from dataclasses import replace

import pytest
from app_graphs import AUTORACE, HOME
from notation import graph_of

from rtron.planning import check_plan, propose_plan, unguardable_topics
from rtron.planning.plan_doubts import void_value_warnings
from rtron.risks import discover_risks
from rtron.vocabulary import (
    GRCN,
    SECOND,
    Action,
    ActionRole,
    Direction,
    Domain,
    Endpoint,
    Flow,
    FpsMonitor,
    FrameSource,
    FunctionType,
    Mode,
    Node,
    Plan,
    PolicyName,
    RiskReport,
    Sharing,
    StreamKind,
    Trust,
    WatchedFlow,
    build_streams,
)


def plan_of(graph) -> Plan:
    return propose_plan(graph, discover_risks(graph))


def moving_plan_of(graph) -> Plan:
    return propose_plan(graph, discover_risks(graph), only_motion=True)


def grcn_of(plan: Plan, topic: str) -> GRCN:
    return next(grcn for grcn in plan.grcn if grcn.topic == topic)


def shared(topic: str, message_type: str, publishers: str = "/a a own,/b b own") -> str:
    nodes = (f"{node}\n pub {topic} {message_type}\n" for node in publishers.split(","))
    return "".join(nodes) + f"/s driver own\n sub {topic} {message_type}\n"


TWIST = "geometry_msgs/Twist"
HOME_PLAN = plan_of(HOME)
AUTORACE_PLAN = plan_of(AUTORACE)


class TestHome:
    def test_has_the_twelve_grcns_of_the_paper_with_three_topics_of_one_action_as_one(self):
        domains = [grcn.domain for grcn in HOME_PLAN.grcn]
        counted = {domain: domains.count(domain) for domain in set(domains)}
        assert counted == {Domain.PERCEPTION: 7, Domain.PLANNING: 2, Domain.CONTROL: 1}

    def test_a_person_at_the_keyboard_drives_before_the_navigation(self):
        grcn = grcn_of(HOME_PLAN, "/cmd_vel")
        assert (grcn.mode, grcn.policy) == (Mode.ENFORCE, PolicyName.PREEMPTION)
        assert grcn.flows == (
            Flow(name="flow1", publisher="/teleop_twist_keyboard", priority=2),
            Flow(name="flow2", publisher="/move_base", priority=1),
        )
        assert grcn.successors == ("/gazebo",)
        assert grcn.kind is StreamKind.COMMAND

    def test_a_goal_of_the_users_own_node_goes_before_that_of_rviz(self):
        grcn = grcn_of(HOME_PLAN, "/move_base_simple/goal")
        assert (grcn.mode, grcn.policy) == (Mode.ENFORCE, PolicyName.PRIORITY_QUEUE)
        assert [flow.publisher for flow in grcn.flows] == ["/search_manager", "/rviz"]
        assert grcn.done == "/move_base/result"
        assert grcn.max_age == 60 * SECOND

    def test_a_viewer_that_publishes_too_is_remapped_at_both_ends(self):
        assert grcn_of(HOME_PLAN, "/move_base_simple/goal").successors == ("/move_base", "/rviz")
        assert "/rviz" not in grcn_of(HOME_PLAN, "/camera/rgb/image_raw").successors
        assert "/rviz" not in grcn_of(HOME_PLAN, "/tf").successors

    def test_an_action_is_enforced_as_a_whole_by_its_goals(self):
        grcn = grcn_of(HOME_PLAN, "/move_base/goal")
        assert (grcn.mode, grcn.policy) == (Mode.ENFORCE, PolicyName.PRIORITY_QUEUE)
        assert grcn.done == "/move_base/result"
        parts = {"/move_base/cancel", "/move_base/status"}
        assert parts.isdisjoint(grcn.topic for grcn in HOME_PLAN.grcn)

    def test_perception_is_observed(self):
        seen = [grcn for grcn in HOME_PLAN.grcn if grcn.domain is Domain.PERCEPTION]
        assert {(grcn.mode, grcn.policy) for grcn in seen} == {(Mode.OBSERVE, PolicyName.BLOCK)}
        assert grcn_of(HOME_PLAN, "/tf").sharing is Sharing.MERGE

    def test_a_node_that_hears_itself_is_publisher_and_successor(self):
        grcn = grcn_of(HOME_PLAN, "/move_base/local_costmap/footprint")
        assert [flow.publisher for flow in grcn.flows] == ["/move_base"]
        assert grcn.successors == ("/move_base",)
        assert grcn.type == "geometry_msgs/PolygonStamped"

    def test_the_rsrcn_stands_before_the_velocity_as_there_is_no_limit_to_it(self):
        rsrcn = HOME_PLAN.rsrcn
        assert (rsrcn.mode, rsrcn.policy) == (Mode.ENFORCE, PolicyName.BLOCK)
        assert [topic.topic for topic in rsrcn.vflows] == ["/cmd_vel"]
        assert [(flow.topic, flow.publisher) for flow in rsrcn.iflows] == [
            ("/objects", "/find_object_3d"),
            ("/person_detector/detections", "/person_detector"),
        ]

    def test_the_msrcn_knows_the_three_events_and_both_actions_of_the_paper(self):
        msrcn = HOME_PLAN.msrcn
        events = {flow.topic for flow in msrcn.eflows}
        assert events == {"/objects", "/person_detector/detections", "/odom"}
        actions = {topic.topic for topic in msrcn.aflows}
        paper = {"/cmd_vel", "/rosbot_audio/audio", "/move_base_simple/goal"}
        assert actions == paper | {"/move_base/goal", "/explore_server/goal"}
        assert msrcn.mode is Mode.ENFORCE
        names = [flow.name for topic in msrcn.aflows for flow in topic.flows]
        assert names == [f"aflow{number}" for number in range(1, len(names) + 1)]
        assert len(names) == 9

    def test_an_event_is_seen_for_two_seconds_until_a_person_says_more(self):
        seen = {(flow.present, flow.silent, flow.when) for flow in HOME_PLAN.msrcn.eflows}
        assert seen == {(2 * SECOND, None, "")}
        types = {flow.topic: flow.type for flow in HOME_PLAN.msrcn.eflows}
        assert types["/odom"] == "nav_msgs/Odometry"
        assert HOME_PLAN.msrcn.rules == ()

    def test_an_image_node_without_debug_image_is_timed_by_what_it_recognises(self):
        assert HOME_PLAN.fps_monitor == (
            FpsMonitor(
                id="fps_find_object_3d",
                node="/find_object_3d",
                topic="/objects",
                source=FrameSource.DETECTIONS,
                camera=None,
            ),
            FpsMonitor(
                id="fps_person_detector",
                node="/person_detector",
                topic="/person_detector/detections",
                source=FrameSource.DETECTIONS,
                camera=WatchedFlow(
                    name="camera", topic="/camera/rgb/image_raw", publisher="/gazebo"
                ),
            ),
        )


class TestAutoRace:
    def test_the_limit_to_the_velocity_is_enforced(self):
        assert grcn_of(AUTORACE_PLAN, "/control/max_vel").mode is Mode.ENFORCE
        assert AUTORACE_PLAN.rsrcn.mode is Mode.ENFORCE
        assert [topic.topic for topic in AUTORACE_PLAN.rsrcn.vflows] == ["/control/max_vel"]

    def test_image_nodes_are_timed_by_the_image_that_they_publish_for_every_frame(self):
        topics = {monitor.node: monitor.topic for monitor in AUTORACE_PLAN.fps_monitor}
        assert topics["/detect_sign"] == "/detect/image_traffic_sign/compressed"
        assert topics["/detect_level"] == "/detect/image_level"
        assert len(topics) == 5
        assert {monitor.source for monitor in AUTORACE_PLAN.fps_monitor} == {FrameSource.FRAMES}

    def test_the_camera_is_the_one_image_that_the_node_hears(self):
        cameras = {monitor.node: monitor.camera for monitor in AUTORACE_PLAN.fps_monitor}
        assert cameras["/detect_sign"] == WatchedFlow(
            name="camera", topic="/camera/image_compensated", publisher="/camera/image_compensation"
        )

    def test_own_nodes_drive_before_those_of_others(self):
        flows = grcn_of(AUTORACE_PLAN, "/cmd_vel").flows
        assert [flow.publisher for flow in flows][-1] == "/move_base"

    def test_where_nobody_publishes_only_strangers_can_so_it_is_observed(self):
        grcn = grcn_of(AUTORACE_PLAN, "/control/level_crossing_finished")
        assert (grcn.mode, grcn.flows) == (Mode.OBSERVE, ())

    def test_a_state_with_one_publisher_never_waits(self):
        grcn = grcn_of(AUTORACE_PLAN, "/core/decided_mode")
        assert (grcn.mode, grcn.policy) == (Mode.ENFORCE, PolicyName.BLOCK)


@pytest.mark.parametrize(("graph", "plan"), [(HOME, HOME_PLAN), (AUTORACE, AUTORACE_PLAN)])
class TestEveryProposal:
    def test_fits_its_app(self, graph, plan):
        assert check_plan(plan, graph) == ()
        assert unguardable_topics(graph, discover_risks(graph)) == ()

    def test_gives_each_flow_a_priority_of_its_own(self, graph, plan):
        for grcn in plan.grcn:
            priorities = [flow.priority for flow in grcn.flows]
            assert priorities == list(range(len(priorities), 0, -1))

    def test_merges_into_one_stream_a_topic_and_mode(self, graph, plan):
        made = build_streams(plan)
        assert len({(stream.topic, stream.mode) for stream in made}) == len(made)

    def test_ids_are_words_of_their_own(self, graph, plan):
        ids = [grcn.id for grcn in plan.grcn] + [monitor.id for monitor in plan.fps_monitor]
        assert len(set(ids)) == len(ids)


class TestOrder:
    def test_trust_comes_first(self):
        publishers = "/a x third_party,/b x unknown,/c x own"
        grcn = plan_of(graph_of("app", shared("/cmd_vel", "geometry_msgs/Twist", publishers))).grcn[
            0
        ]
        assert [flow.publisher for flow in grcn.flows] == ["/c", "/b", "/a"]

    def test_a_name_proves_nothing(self):
        publishers = "/safe_control x third_party,/anything x unknown"
        grcn = plan_of(graph_of("app", shared("/cmd_vel", "geometry_msgs/Twist", publishers))).grcn[
            0
        ]
        assert grcn.flows[0].publisher == "/anything"

    def test_then_what_a_node_does(self):
        names = ("a_teleop", "b_shows", "c_speaks", "d_works", "e_plans", "f_serves")
        text = shared(
            "/cmd_vel", "geometry_msgs/Twist", ",".join(f"/{name} x own" for name in names)
        )
        text += "/d_works x own\n sub /scan p/T\n/f_serves x own\n server /drive p/Drive\n"
        graph = graph_of("app", text)
        functions = {
            "/a_teleop": FunctionType.TELEOPERATION,
            "/b_shows": FunctionType.VISUALIZATION,
            "/e_plans": FunctionType.PATH_PLANNING,
        }
        nodes = tuple(replace(n, function=functions.get(n.name)) for n in graph.nodes)
        flows = grcn_of(plan_of(replace(graph, nodes=nodes)), "/cmd_vel").flows
        order = [flow.publisher for flow in flows]
        assert order == ["/a_teleop", "/e_plans", "/f_serves", "/d_works", "/c_speaks", "/b_shows"]

    @pytest.mark.parametrize(("trust", "first"), [("own", "/z_e_stop"), ("third_party", "/nav")])
    def test_an_emergency_stop_of_ones_own_goes_first(self, trust, first):
        text = shared("/cmd_vel", "geometry_msgs/Twist", f"/nav x {trust},/z_e_stop x {trust}")
        flows = grcn_of(plan_of(graph_of("app", text)), "/cmd_vel").flows
        assert flows[0].publisher == first

    @pytest.mark.parametrize("trust", ["unknown", "third_party"])
    def test_the_function_of_a_stranger_puts_it_behind_never_before(self, trust):
        names = ("a_planner", "b_works", "c_teleop")
        text = shared(
            "/cmd_vel", "geometry_msgs/Twist", ",".join(f"/{name} x {trust}" for name in names)
        )
        text += f"/b_works x {trust}\n sub /scan p/T\n/c_teleop x {trust}\n sub /joy p/T\n"
        graph = graph_of("app", text)
        functions = {
            "/a_planner": FunctionType.PATH_PLANNING,
            "/c_teleop": FunctionType.TELEOPERATION,
        }
        nodes = tuple(replace(n, function=functions.get(n.name)) for n in graph.nodes)
        flows = grcn_of(plan_of(replace(graph, nodes=nodes)), "/cmd_vel").flows
        assert [flow.publisher for flow in flows] == ["/c_teleop", "/b_works", "/a_planner"]

    def test_who_serves_an_action_is_known_by_its_five_topics_too(self):
        text = shared("/cmd_vel", "geometry_msgs/Twist") + "/b b own\n server /drive p/Drive\n"
        text += "/a a own\n sub /scan p/T\n"
        graph = replace(graph_of("app", text), actions=())
        flows = grcn_of(plan_of(graph), "/cmd_vel").flows
        assert [flow.publisher for flow in flows] == ["/b", "/a"]

    def test_a_tool_that_only_shows_comes_last_whatever_it_hears(self):
        text = shared("/x/goal", "geometry_msgs/Pose", "/a rviz own,/b mouse own")
        graph = graph_of("app", text + "/a rviz own\n sub /scan p/T\n")
        flows = grcn_of(plan_of(graph), "/x/goal").flows
        assert [flow.publisher for flow in flows] == ["/b", "/a"]

    def test_a_node_that_the_graph_does_not_list_is_unknown(self):
        graph = graph_of(
            "app", shared("/cmd_vel", "geometry_msgs/Twist", "/a x own,/b x third_party")
        )
        known = tuple(node for node in graph.nodes if node.name != "/b")
        other = Node(name="/a", trust=Trust.THIRD_PARTY)
        flows = plan_of(replace(graph, nodes=(other, *known[1:]))).grcn[0].flows
        assert [flow.publisher for flow in flows] == ["/b", "/a"]


class TestWhatMoves:
    def test_what_moves_nothing_is_left_out_and_what_risks_watch_stays(self):
        plan = moving_plan_of(HOME)
        assert {grcn.domain for grcn in plan.grcn} == {Domain.PLANNING, Domain.CONTROL}
        enforced = [grcn for grcn in HOME_PLAN.grcn if grcn.mode is Mode.ENFORCE]
        assert list(plan.grcn) == enforced
        rest = (plan.rsrcn, plan.msrcn, plan.fps_monitor)
        assert rest == (HOME_PLAN.rsrcn, HOME_PLAN.msrcn, HOME_PLAN.fps_monitor)

    @pytest.mark.parametrize(
        ("package", "is_guarded"), [("nav2_behaviors", False), ("my_pkg", True)]
    )
    def test_what_one_stack_sends_itself_needs_no_guard_of_its_own(self, package, is_guarded):
        text = f"/c nav2_controller unknown\n pub /cmd_vel_nav {TWIST}\n"
        text += f"/b {package} unknown\n pub /cmd_vel_nav {TWIST}\n"
        text += f"/s nav2_velocity_smoother unknown\n sub /cmd_vel_nav {TWIST}\n"
        plan = moving_plan_of(graph_of("app", text))
        assert [grcn.topic for grcn in plan.grcn] == ["/cmd_vel_nav"] * is_guarded

    def test_the_last_command_is_guarded_also_within_one_stack(self):
        text = f"/c nav2_controller unknown\n pub /cmd_vel {TWIST}\n"
        text += f"/d opennav_docking unknown\n pub /cmd_vel {TWIST}\n"
        graph = graph_of("app", text)
        plan = propose_plan(graph, discover_risks(graph), {"/cmd_vel": ()}, only_motion=True)
        assert [grcn.topic for grcn in plan.grcn] == ["/cmd_vel"]

    @pytest.mark.parametrize(
        ("type", "publishers", "policy"),
        [
            ("p/Frame", "/wheels a own,/lamps b own", PolicyName.BLOCK),
            ("p/Frame", "/wheels a own", PolicyName.PREEMPTION),
            (TWIST, "/nav a own,/teleop b own", PolicyName.PREEMPTION),
        ],
    )
    def test_frames_of_several_drivers_for_one_board_do_not_end_each_other(
        self, type, publishers, policy
    ):
        graph = graph_of("app", shared("/board/input", type, publishers))
        last = {"/board/input": ()}
        plan = propose_plan(graph, discover_risks(graph), last, only_motion=True)
        grcn = grcn_of(plan, "/board/input")
        assert (grcn.mode, grcn.policy) == (Mode.ENFORCE, policy)
        assert len(grcn.flows) == len(publishers.split(","))


class TestQueues:
    def test_a_goal_without_a_known_end_counts_as_done_after_a_while(self):
        grcn = plan_of(graph_of("app", shared("/goal", "geometry_msgs/PoseStamped"))).grcn[0]
        assert grcn.done is None
        assert {flow.timeout for flow in grcn.flows} == {10 * SECOND}

    def test_the_end_is_the_result_of_the_action_that_the_successor_serves(self):
        text = (
            shared("/my/goal", "geometry_msgs/PoseStamped") + "/s driver own\n server /drive p/D\n"
        )
        assert grcn_of(plan_of(graph_of("app", text)), "/my/goal").done == "/drive/result"

    def test_a_state_of_planning_waits_no_longer_than_half_a_second(self):
        grcn = plan_of(graph_of("app", shared("/robot_mode", "std_msgs/UInt8"))).grcn[0]
        assert grcn.policy is PolicyName.PRIORITY_QUEUE
        assert {flow.timeout for flow in grcn.flows} == {SECOND // 2}


class TestGuards:
    def test_without_risks_there_is_nothing_to_guard(self):
        assert plan_of(graph_of("quiet", "/a a own\n pub /x p/T\n")) == Plan(app="quiet")

    def test_where_no_grcn_enforces_the_msrcn_observes_all_it_knows(self):
        text = (
            "/a a own\n pub /cmd_vel geometry_msgs/Twist\n client /move p/Move\n"
            "/b b own\n sub /cmd_vel geometry_msgs/Twist\n server /move p/Move\n"
        )
        msrcn = plan_of(graph_of("app", text)).msrcn
        assert msrcn.mode is Mode.OBSERVE
        assert [topic.topic for topic in msrcn.aflows] == ["/cmd_vel", "/move/goal"]

    def test_an_enforcing_msrcn_takes_an_action_by_its_goals(self):
        text = shared("/cmd_vel", "geometry_msgs/Twist")
        text += "/a a own\n client /move p/Move\n/s s own\n server /move p/Move\n"
        msrcn = plan_of(graph_of("app", text)).msrcn
        assert msrcn.mode is Mode.ENFORCE
        assert [topic.topic for topic in msrcn.aflows] == ["/cmd_vel", "/move/goal"]

    def test_who_only_cancels_has_a_flow_too(self):
        text = shared("/move/goal", "p/MoveActionGoal")
        text += "/s s own\n server /move p/Move\n"
        text += "/stop s own\n pub /move/cancel actionlib_msgs/GoalID\n"
        grcn = grcn_of(plan_of(graph_of("app", text)), "/move/goal")
        assert "/stop" in [flow.publisher for flow in grcn.flows]

    def test_goals_of_unknown_type_are_only_observed(self):
        graph = graph_of("app", shared("/move/goal", "p/T") + "/s s own\n server /move p/Move\n")
        assert grcn_of(plan_of(graph), "/move/goal").mode is Mode.OBSERVE

    def test_an_action_is_known_by_its_five_topics_too(self):
        graph = graph_of("app", shared("/move/goal", "p/T") + "/s s own\n server /move p/Move\n")
        ends = tuple(end for end in graph.endpoints if end.topic != "/move/result")
        assert grcn_of(plan_of(replace(graph, actions=())), "/move/goal").mode is Mode.OBSERVE
        four = replace(graph, actions=(), topics=(), endpoints=ends)
        assert grcn_of(plan_of(four), "/move/goal").mode is Mode.ENFORCE

    def test_an_image_of_what_is_recognised_times_best(self):
        text = (
            "/n n own\n sub /camera sensor_msgs/Image\n"
            " pub /{a,detect,z}/image sensor_msgs/Image\n pub /detect/a p/T\n"
        )
        (monitor,) = plan_of(graph_of("app", text)).fps_monitor
        assert monitor.topic == "/detect/image"
        (monitor,) = plan_of(graph_of("app", text.replace("a,detect,z", "a,z"))).fps_monitor
        assert monitor.topic == "/a/image"

    @pytest.mark.parametrize(
        ("heard", "spoken", "camera"),
        [
            ("/camera", "/driver own\n pub /camera sensor_msgs/Image\n", "/driver"),
            ("/camera", "", None),
            ("/camera", "/a a own\n pub /camera sensor_msgs/Image\n" * 2, "/a"),
            ("/{left,right}", "/driver own\n pub /{left,right} sensor_msgs/Image\n", None),
            (
                "/camera",
                "".join(f"/{n} n own\n pub /camera sensor_msgs/Image\n" for n in "ab"),
                None,
            ),
            ("/camera", "/n n own\n pub /camera sensor_msgs/Image\n", None),
        ],
    )
    def test_a_camera_is_proposed_where_there_is_no_doubt(self, heard, spoken, camera):
        text = f"/n n own\n sub {heard} sensor_msgs/Image\n pub /detect/a p/T\n"
        spoken = spoken.replace("/driver own", "/driver driver own")
        (monitor,) = plan_of(graph_of("app", text + spoken)).fps_monitor
        assert (monitor.camera and monitor.camera.publisher) == camera

    def test_no_topic_is_both_event_and_action(self):
        text = "/n n own\n pub /detect/goal geometry_msgs/PoseStamped\n"
        text += "/s s own\n sub /detect/goal geometry_msgs/PoseStamped\n"
        text += " pub /detect/other p/T\n"
        msrcn = plan_of(graph_of("app", text)).msrcn
        assert [topic.topic for topic in msrcn.aflows] == ["/detect/goal"]
        assert [(flow.name, flow.topic) for flow in msrcn.eflows] == [("eflow1", "/detect/other")]


class TestNamesWithHoles:
    def test_everything_that_is_left_out_is_told_in_order(self):
        graph = graph_of("app", "".join(shared(f"/{x}", "geometry_msgs/Twist") for x in "dbca"))
        ends = tuple(
            replace(e, topic=f"{{p}}{e.topic}", node=f"{{n}}{e.node}") for e in graph.endpoints
        )
        graph = replace(graph, topics=(), endpoints=ends)
        told = [problem.location for problem in unguardable_topics(graph, discover_risks(graph))]
        assert told == ["{p}/a", "{p}/b", "{p}/c", "{p}/d", "{n}/a", "{n}/b"]

    def test_a_topic_whose_name_is_not_known_is_left_out_and_told(self):
        graph = graph_of("app", shared("/x", "geometry_msgs/Twist"))
        ends = tuple(replace(e, topic="{prefix}/cmd_vel") for e in graph.endpoints)
        graph = replace(graph, endpoints=ends)
        assert plan_of(graph).grcn == ()
        (problem,) = unguardable_topics(graph, discover_risks(graph))
        assert str(problem).startswith("warning: {prefix}/cmd_vel: cannot be guarded")

    def test_a_topic_is_not_enforced_while_a_publisher_cannot_be_named(self):
        graph = graph_of("app", shared("/cmd_vel", "geometry_msgs/Twist"))
        more = Endpoint(node="/{ns}/c", topic="/cmd_vel", direction=Direction.PUBLISH)
        graph = replace(graph, endpoints=(*graph.endpoints, more))
        grcn = plan_of(graph).grcn[0]
        assert (grcn.mode, len(grcn.flows)) == (Mode.OBSERVE, 2)
        assert [
            problem.location for problem in unguardable_topics(graph, discover_risks(graph))
        ] == ["/{ns}/c"]

    def test_names_that_differ_in_slashes_only_have_ids_of_their_own(self):
        text = shared("/a/cmd_vel", "geometry_msgs/Twist") + shared(
            "/a_cmd_vel", "geometry_msgs/Twist"
        )
        ids = [grcn.id for grcn in plan_of(graph_of("app", text)).grcn]
        assert ids == ["grcn_a_cmd_vel", "grcn_a_cmd_vel_2"]


def test_a_report_without_classes_makes_a_plan_that_only_watches():
    report = discover_risks(HOME)
    bare = RiskReport(app="", risks=report.risks, coordination_nodes=report.coordination_nodes)
    assert {grcn.mode for grcn in propose_plan(HOME, bare).grcn} == {Mode.OBSERVE}


class TestRos2Actions:
    TYPE = "nav2_msgs/action/NavigateToPose"

    def graph(self, *clients, servers=("/server",), type=TYPE):
        sides = [(node, ActionRole.CLIENT) for node in clients]
        sides += [(node, ActionRole.SERVER) for node in servers]
        actions = tuple(Action(node=node, name="/go", type=type, role=role) for node, role in sides)
        graph = graph_of("app", shared("/x", "p/T"), ros=2)
        return replace(graph, actions=actions)

    def test_clients_and_a_server_get_a_grcn_on_the_action_itself(self):
        graph = self.graph("/one", "/two")
        grcn = grcn_of(plan_of(graph), "/go")
        assert (grcn.type, grcn.mode, grcn.policy) == (
            self.TYPE,
            Mode.ENFORCE,
            PolicyName.PRIORITY_QUEUE,
        )
        assert {flow.publisher for flow in grcn.flows} == {"/one", "/two"}
        assert {flow.timeout for flow in grcn.flows} == {None}
        assert (grcn.successors, grcn.max_age, grcn.done) == (("/server",), 60 * SECOND, None)
        assert unguardable_topics(graph, discover_risks(graph)) == ()

    def test_the_msrcn_can_block_it(self):
        (topic,) = plan_of(self.graph("/one", "/two")).msrcn.aflows
        assert (topic.topic, topic.type, topic.successors) == ("/go", self.TYPE, ("/server",))

    def test_what_a_server_asks_of_itself_is_no_flow(self):
        grcn = grcn_of(plan_of(self.graph("/one", "/two", "/server")), "/go")
        assert {flow.publisher for flow in grcn.flows} == {"/one", "/two"}

    def test_without_a_server_there_is_nothing_to_guard(self):
        plan = plan_of(self.graph("/one", servers=()))
        assert plan.msrcn.aflows == ()

    def test_without_its_type_it_cannot_be_guarded(self):
        graph = self.graph("/one", "/two", type="")
        assert not [each for each in plan_of(graph).grcn if each.topic == "/go"]
        (problem,) = unguardable_topics(graph, discover_risks(graph))
        assert str(problem) == (
            "warning: /go: cannot be guarded: the type of the action is not known"
        )

    def test_the_plan_fits_the_graph_that_it_is_made_for(self):
        graph = self.graph("/one", "/two", "/server")
        assert check_plan(plan_of(graph), graph) == ()

    def test_an_action_needs_its_type(self):
        graph = self.graph("/one", "/two")
        plan = plan_of(graph)
        bare = replace(plan, grcn=tuple(replace(g, type="") for g in plan.grcn), msrcn=None)
        told = [str(problem) for problem in check_plan(bare, graph)]
        assert (
            "error: GRCN grcn_go: /go is an action, not a topic: say its type, pkg/action/Name"
            in told
        )


class TestRos2Poses:
    """Poses that a server makes a goal of its own action of."""

    def graph(self, *actions, topic="/goal_pose"):
        text = (
            shared(topic, "geometry_msgs/PoseStamped", "/rviz rviz2 own,/mission m own")
            + f"/bt_navigator nav2 own\n sub {topic} geometry_msgs/PoseStamped\n/other o own\n"
        )
        served = tuple(
            Action(node=node, name=name, type=TestRos2Actions.TYPE, role=ActionRole.SERVER)
            for node, name in actions
        )
        return replace(graph_of("app", text, ros=2), actions=served)

    @pytest.mark.parametrize(
        ("topic", "actions", "done"),
        [
            ("/goal_pose", ["/navigate_to_pose", "/navigate_through_poses"], "/navigate_to_pose"),
            ("/a/goal_pose", ["/a/navigate_to_pose", "/a/other"], "/a/navigate_to_pose"),
            ("/goal", ["/go"], "/go"),
            ("/goal_pose", ["/go", "/other"], None),
            ("/goal_pose", [], None),
            ("/goal_poses", ["/go"], None),
        ],
    )
    def test_the_action_that_tells_when_a_pose_is_done(self, topic, actions, done):
        graph = self.graph(*(("/bt_navigator", name) for name in actions), topic=topic)
        grcn = grcn_of(plan_of(graph), topic)
        assert (grcn.policy, grcn.done) == (PolicyName.PRIORITY_QUEUE, done)
        assert {flow.timeout for flow in grcn.flows} == ({None} if done else {10 * SECOND})
        assert check_plan(plan_of(graph), graph) == ()

    def test_another_node_s_action_tells_nothing(self):
        graph = self.graph(("/other", "/navigate_to_pose"))
        assert grcn_of(plan_of(graph), "/goal_pose").done is None

    def test_the_action_must_be_there_and_be_a_successor_s(self):
        graph = self.graph(("/bt_navigator", "/navigate_to_pose"), ("/other", "/go"))
        plan = plan_of(graph)

        def told(done):
            (grcn,) = (replace(each, done=done) for each in plan.grcn if each.done)
            return [str(each) for each in check_plan(replace(plan, grcn=(grcn,)), graph)]

        assert told("/navigate_to_pose") == []
        assert told("/navigate_to_pos") == [
            (
                "error: GRCN grcn_goal_pose, done: no topic /navigate_to_pos in the app: "
                "did you mean /navigate_to_pose?"
            )
        ]
        assert told("/go") == [
            (
                "error: GRCN grcn_goal_pose, done: /go is told by /other, "
                "and only a successor of /goal_pose is believed"
            )
        ]


@pytest.mark.parametrize(
    ("type", "size"), [("geometry_msgs/Twist", 100), ("std_msgs/UInt8MultiArray", 16)]
)
def test_a_queue_has_room_for_what_it_is_to_hold(type, size):
    plan = plan_of(graph_of("app", shared("/cmd_raw", type)))
    grcn = grcn_of(plan, "/cmd_raw")
    assert (grcn.mode, grcn.queue_size) == (Mode.ENFORCE, size)
    assert not [each for each in void_value_warnings(plan) if "queue_size" in each.message]
