"""A plan is held against its app: each thing that does not fit is told with what would."""

from dataclasses import replace

import pytest
from app_graphs import HOME

from rtron.planning import check_plan, propose_plan
from rtron.risks import discover_risks
from rtron.vocabulary import (
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    InteractionGraph,
    Mode,
    Topic,
    WatchedFlow,
)

PLAN = propose_plan(HOME, discover_risks(HOME))
CMD_VEL = PLAN.grcn[0]


def told(plan) -> list[str]:
    return [str(problem) for problem in check_plan(plan, HOME)]


def with_grcn(**changes):
    return replace(PLAN, grcn=(replace(CMD_VEL, **changes), *PLAN.grcn[1:]))


def with_first_flow(**changes):
    first, *others = CMD_VEL.flows
    return with_grcn(flows=(replace(first, **changes), *others))


def test_a_plan_that_fits_has_no_problem():
    assert check_plan(PLAN, HOME) == ()


def test_an_unknown_topic_names_the_nearest():
    assert told(with_grcn(topic="/cmd_val")) == [
        "error: GRCN grcn_cmd_vel: no topic /cmd_val in the app: did you mean /cmd_vel?"
    ]


def test_a_topic_like_none_of_very_many():
    assert told(with_grcn(topic="/zzzzzzz"))[0].endswith("none of the 125 is like it")


def test_an_unknown_publisher_names_the_nearest():
    assert told(with_first_flow(publisher="/move_bas"))[0] == (
        "error: GRCN grcn_cmd_vel, flow1: no node /move_bas in the app: did you mean /move_base?"
    )


def test_a_client_of_a_bridge_is_in_no_graph():
    assert (
        told(with_grcn(flows=(*CMD_VEL.flows, Flow(name="web", publisher="/bridge/tablet")))) == []
    )


def test_a_flow_that_nobody_publishes():
    assert told(with_first_flow(publisher="/gazebo"))[0] == (
        "error: GRCN grcn_cmd_vel, flow1: /gazebo does not publish /cmd_vel: "
        "/move_base and /teleop_twist_keyboard do"
    )


def test_a_publisher_that_no_flow_names_counts_as_unapproved():
    assert told(with_grcn(flows=CMD_VEL.flows[:1])) == [
        (
            "warning: GRCN grcn_cmd_vel: no flow names /move_base, which publishes /cmd_vel: it "
            "counts as unapproved"
        )
    ]


def test_a_pattern_names_every_node_that_it_matches():
    flow = replace(CMD_VEL.flows[0], publisher="/*")
    assert told(with_grcn(flows=(flow,))) == []


@pytest.mark.parametrize(
    ("successor", "fault"),
    [
        ("/gazeb", "no node /gazeb in the app: did you mean /gazebo"),
        ("/rviz", "does not subscribe"),
    ],
)
def test_a_successor_that_does_not_listen(successor, fault):
    assert any(fault in text for text in told(with_grcn(successors=("/gazebo", successor))))


def test_a_subscriber_that_the_plan_forgets_hears_the_public_name():
    (text,) = told(with_grcn(successors=()))
    assert text.startswith(
        "warning: GRCN grcn_cmd_vel: /gazebo is no successor: it hears the public"
    )
    assert told(with_grcn(successors=(), mode=Mode.OBSERVE)) == []


def test_the_end_of_an_action_must_be_a_topic_of_the_app():
    assert told(with_grcn(done="/move_base/resul")) == [
        (
            "error: GRCN grcn_cmd_vel, done: no topic /move_base/resul in the app: "
            "did you mean /move_base/result?"
        )
    ]


def test_only_a_successor_is_believed_about_the_end_of_an_action():
    (text,) = told(with_grcn(done="/move_base/result"))
    assert text == (
        "error: GRCN grcn_cmd_vel, done: /move_base/result is told by /move_base, "
        "and only a successor of /cmd_vel is believed"
    )
    assert told(with_grcn(done="/odom")) == []


def test_one_topic_of_an_action_should_not_be_enforced_alone():
    goal = next(grcn for grcn in PLAN.grcn if grcn.topic == "/move_base/goal")
    cancel = replace(goal, topic="/move_base/cancel", type="actionlib_msgs/GoalID")
    assert [text for text in told_of(cancel) if "one topic of an action" in text]
    *_, message = told_of(replace(goal, type=""))
    assert message.endswith("guard its goals, and say their type, pkg/NameActionGoal")
    assert told_of(goal) == []


def told_of(grcn):
    return [
        each.message
        for each in check_plan(
            replace(PLAN, msrcn=None, rsrcn=None, fps_monitor=(), grcn=(grcn,)), HOME
        )
    ]


def test_what_is_only_watched_is_checked_too():
    eflow = EventFlow(name="eflow1", topic="/odo", publisher="/gazebo")
    silent = EventFlow(name="eflow2", topic="/odom", publisher="/rviz")
    plan = replace(PLAN, msrcn=replace(PLAN.msrcn, eflows=(eflow, silent)))
    assert told(plan) == [
        "error: MSRCN, eflow1: no topic /odo in the app: did you mean /odom?",
        "error: MSRCN, eflow2: /rviz does not publish /odom: /gazebo does",
    ]
    monitor = FpsMonitor(
        id="fps", node="/find_object_3", topic="/objects", source=FrameSource.DETECTIONS
    )
    assert told(replace(PLAN, fps_monitor=(monitor,))) == [
        "error: fps_monitor fps: no node /find_object_3 in the app: did you mean /find_object_3d?"
    ]


@pytest.mark.parametrize(
    ("topic", "publisher", "fault"),
    [
        ("/camera/rgb/image", "/gazebo", "no topic /camera/rgb/image in the app: did you mean"),
        ("/camera/rgb/image_raw", "/rviz", "/rviz does not publish /camera/rgb/image_raw: /gazebo"),
        ("/camera/rgb/image_raw", "/gazeb", "no node /gazeb in the app: did you mean /gazebo"),
    ],
)
def test_a_camera_is_checked_too(topic, publisher, fault):
    camera = WatchedFlow(name="camera", topic=topic, publisher=publisher)
    monitor = replace(PLAN.fps_monitor[0], camera=camera)
    (text,) = told(replace(PLAN, fps_monitor=(monitor,)))
    assert text.startswith("error: fps_monitor fps_find_object_3d, camera: ")
    assert fault in text


def monitored(topic, source=FrameSource.FRAMES):
    node = min(end.node for end in HOME.publishers(topic))
    monitor = FpsMonitor(id="fps", node=node, topic=topic, source=source)
    return replace(PLAN, fps_monitor=(monitor,))


def test_an_empty_scene_must_not_freeze_the_robot():
    (text,) = told(monitored("/objects"))
    assert text.startswith("warning: fps_monitor fps: /objects carries no images (std_msgs/")
    assert "an empty scene would freeze the robot; say `source: detections`" in text
    assert told(monitored("/objects", FrameSource.DETECTIONS)) == []


@pytest.mark.parametrize(
    "topic",
    [
        "/camera/rgb/image_raw",
        "/camera/rgb/image_raw/compressed",
        "/camera/rgb/camera_info",
        "/camera/depth/points",
    ],
)
def test_what_comes_with_every_frame_counts_as_frames(topic):
    assert told(monitored(topic)) == []


def test_a_monitor_on_a_topic_of_unknown_type_is_not_doubted():
    ends = tuple(replace(end, type="") for end in HOME.endpoints)
    graph = replace(HOME, endpoints=ends, topics=())
    assert check_plan(monitored("/objects"), graph) == ()


def test_the_type_of_a_guarded_topic_is_that_of_the_app():
    assert told(with_grcn(type="geometry_msgs/msg/Twist")) == []
    assert told(with_grcn(type="")) == []
    assert told(with_grcn(type="geometry_msgs/TwistStamped")) == [
        (
            "error: GRCN grcn_cmd_vel: /cmd_vel carries geometry_msgs/Twist, "
            "not geometry_msgs/TwistStamped"
        )
    ]


def test_the_type_of_an_event_is_that_of_the_app():
    first, *others = PLAN.msrcn.eflows
    wrong = replace(first, type="nav_msgs/Path")
    (text,) = told(replace(PLAN, msrcn=replace(PLAN.msrcn, eflows=(wrong, *others))))
    assert text == f"error: MSRCN, eflow1: {first.topic} carries {first.type}, not nav_msgs/Path"


def test_a_type_that_the_graph_declares_for_a_topic_without_ends_counts():
    graph = InteractionGraph(app="", topics=(Topic(name="/cmd_vel", types=("a/B",)),))
    (text, *_) = [str(p) for p in check_plan(replace(PLAN, grcn=(CMD_VEL,)), graph)]
    assert "/cmd_vel carries a/B, not geometry_msgs/Twist" in text


def test_guarded_topics_are_checked_like_those_of_a_grcn():
    topic = replace(PLAN.rsrcn.vflows[0], topic="/cmd_vell")
    plan = replace(PLAN, rsrcn=replace(PLAN.rsrcn, vflows=(topic,)))
    assert told(plan) == [
        "error: RSRCN on /cmd_vell: no topic /cmd_vell in the app: did you mean /cmd_vel?"
    ]


def test_nothing_fits_an_empty_app():
    assert all(
        "the graph has none" in p.message for p in check_plan(PLAN, InteractionGraph(app=""))
    )
