"""Values that leave a policy without effect, and orders that are a guess."""

from dataclasses import replace

import pytest
from plans import grcn, plan_of

from rtron.planning.plan_doubts import order_doubts, silence_doubts, void_value_warnings
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    Direction,
    Endpoint,
    Flow,
    FunctionType,
    GuardedTopic,
    InteractionGraph,
    MessageDefinition,
    Mode,
    Node,
    NodeParameter,
    Plan,
    PolicyName,
    StreamKind,
    Trust,
    WiringFact,
    WiringFactKind,
)


def warnings(**settings):
    return [
        str(each) for each in void_value_warnings(plan_of(grcn("/cmd_vel", ["/a"], [], **settings)))
    ]


def test_a_plan_with_usual_values_has_none():
    assert warnings() == []


def test_a_long_duration_is_doubted():
    (warning,) = warnings(release_after=3 * SECOND)
    assert warning == (
        "warning: GRCN grcn_cmd_vel: release_after is 3 s: so long nobody else drives when a node "
        "falls silent"
    )


@pytest.mark.parametrize(("size", "is_doubted"), [(16, False), (17, True)])
def test_a_queue_that_has_no_room_for_its_messages_is_doubted(size, is_doubted):
    found = warnings(type="sensor_msgs/Image", kind=StreamKind.STATE, queue_size=size)
    assert bool(found) == is_doubted
    if is_doubted:
        assert found[0] == (
            "warning: GRCN grcn_cmd_vel: queue_size is 17, and a queue holds 67 MB: of "
            "sensor_msgs/Image, at 4 MB each, 16; of larger ones, fewer"
        )


def test_the_definition_of_a_type_of_ones_own_counts():
    plan = replace(
        plan_of(grcn("/scan", ["/a"], [], type="my_msgs/Sweep", kind=StreamKind.STATE)),
        messages=(
            MessageDefinition(
                type="my_msgs/Sweep", definition="float64[65536] a\nfloat64[65536] b"
            ),
        ),
    )
    (warning,) = void_value_warnings(plan)
    assert "at 1 MB each, 64;" in warning.message
    assert not list(void_value_warnings(replace(plan, messages=())))


LARGE = ("Image", "CompressedImage", "PointCloud", "PointCloud2")


@pytest.mark.parametrize("name", LARGE)
@pytest.mark.parametrize("package", ["sensor_msgs", "sensor_msgs/msg"])
@pytest.mark.parametrize("mode", list(Mode))
def test_large_messages_in_the_process_of_the_commands_are_told(package, name, mode):
    settings = {"type": f"{package}/{name}", "queue_size": 1, "mode": mode}
    told = (
        "warning: GRCN grcn_cmd_vel: pictures and point clouds are carried beside commands, which "
        "wait for them: say `kind: state`"
    )
    assert told in warnings(**settings)
    assert told not in warnings(kind=StreamKind.STATE, **settings)


def test_large_messages_that_a_rule_blocks_are_told():
    """A rule takes its topic into the process of the commands, whatever the GRCN says."""
    pictures, scans = (
        GuardedTopic(topic=topic, type=type, flows=())
        for topic, type in (("/image", "sensor_msgs/Image"), ("/scan", "sensor_msgs/LaserScan"))
    )
    camera = grcn("/image", ["/camera"], [], type="sensor_msgs/Image", kind=StreamKind.STATE)
    mission = MSRCN(
        id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=(pictures, scans)
    )
    (warning,) = void_value_warnings(plan_of(replace(camera, queue_size=1), msrcn=mission))
    assert str(warning) == (
        "warning: MSRCN on /image: pictures and point clouds are carried beside commands, which "
        "wait for them: put the rule on a topic of small messages"
    )


def test_a_node_that_only_watches_voids_nothing():
    texts = warnings(mode=Mode.OBSERVE, release_after=3 * SECOND)
    assert texts == ["warning: plan: nothing enforces: the guard only watches; set `mode: enforce`"]


def test_where_every_flow_is_blocked_nothing_passes():
    plan = plan_of(grcn("/cmd_vel", ["/a", "/b"], []))
    (node,) = plan.grcn
    one, both = (
        tuple(replace(flow, block=number < count) for number, flow in enumerate(node.flows))
        for count in (1, 2)
    )
    assert not list(void_value_warnings(replace(plan, grcn=(replace(node, flows=one),))))
    (warning,) = void_value_warnings(replace(plan, grcn=(replace(node, flows=both),)))
    assert "every flow is blocked" in warning.message


def test_a_lease_that_the_policy_does_not_ask_for_has_no_effect():
    (warning,) = void_value_warnings(plan_of(grcn("/cmd_vel", ["/a"], [], lease="base")))
    assert warning.message == "`lease: base` has no effect: the policy is Preemption, not Lease"
    leased = grcn("/cmd_vel", ["/a"], [], lease="base", policy=PolicyName.LEASE)
    assert not list(void_value_warnings(plan_of(leased)))


@pytest.mark.parametrize(("fastest", "warned"), [(None, False), (2.5, False), (2.51, True)])
def test_a_stop_that_is_steeper_than_its_own_ramp_is_told(fastest, warned):
    limits = RSRCN(
        id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.CONSTRAIN, max_vel_limit=fastest
    )
    found = [str(each) for each in void_value_warnings(Plan(app="base", rsrcn=limits))]
    told = "warning: stop: every stop ends within 1 s, and at 2.5 m/s2 it takes 1 s from 2.51 m/s"
    assert found == ([f"{told}: it is steeper"] if warned else [])


def doubts(known=(), **settings):
    plan = plan_of(grcn("/cmd_vel", ["/a", "/b"], [], **settings))
    (node,) = plan.grcn
    flows = tuple(replace(f, priority=2 - n) for n, f in enumerate(node.flows))
    functions = dict(
        zip(known, (FunctionType.TELEOPERATION, FunctionType.PATH_PLANNING), strict=False)
    )
    nodes = tuple(
        Node(name=name, function=functions.get(name), trust=Trust.OWN) for name in ("/a", "/b")
    )
    proposed = replace(plan, grcn=(replace(node, flows=flows),))
    return proposed, InteractionGraph(app="x", nodes=nodes)


def test_the_order_of_unknown_nodes_is_a_guess_until_somebody_decides():
    plan, graph = doubts(known=["/a"])
    (warning,) = order_doubts(plan, graph)
    assert "nothing tells what these do: /b;" in warning.message
    (node,) = plan.grcn
    decided = tuple(replace(flow, priority=flow.priority * 10) for flow in node.flows)
    assert not list(order_doubts(replace(plan, grcn=(replace(node, flows=decided),)), graph))


@pytest.mark.parametrize(
    ("known", "settings"),
    [
        (["/a", "/b"], {}),
        ([], {"mode": Mode.OBSERVE}),
        ([], {"policy": PolicyName.BLOCK}),
        ([], {"policy": PolicyName.FIFO_QUEUE}),
    ],
)
def test_where_all_is_known_or_nothing_is_ordered_there_is_no_doubt(known, settings):
    assert not list(order_doubts(*doubts(known, **settings)))


def test_the_order_of_two_sources_of_one_kind_is_a_guess():
    plan, graph = doubts(known=["/a", "/b"])
    nodes = tuple(replace(node, function=FunctionType.TELEOPERATION) for node in graph.nodes)
    (warning,) = order_doubts(plan, replace(graph, nodes=nodes))
    assert "nothing tells which of these goes first: /a and /b;" in warning.message
    for shared in ({"process": "/container"}, {"package": "nav2_behaviors"}):
        parts = tuple(replace(node, **shared) for node in nodes)
        assert not list(order_doubts(plan, replace(graph, nodes=parts)))


def test_a_single_flow_has_no_order():
    plan = plan_of(grcn("/cmd_vel", ["/a"], [], policy=PolicyName.PREEMPTION))
    (node,) = plan.grcn
    flow = Flow(name="flow1", publisher="/a", priority=1)
    graph = InteractionGraph(app="x", nodes=(Node(name="/a"),))
    assert not list(order_doubts(replace(plan, grcn=(replace(node, flows=(flow,)),)), graph))


@pytest.mark.parametrize(
    ("ros", "rate", "package", "fate", "is_doubted"),
    [
        (1, None, "joy", "", True),
        (1, 20, "joy", "", False),
        (1, 0.0, "joy", "", True),
        (2, None, "joy", "", False),
        (2, 0, "joy_linux", "", True),
        (1, None, "radio", "", False),
        (1, None, "joy", "repeated", False),
    ],
)
def test_a_joystick_that_sends_on_change_alone_is_silent_while_it_is_held(
    ros, rate, package, fate, is_doubted
):
    ends = [("/pad", "/joy", Direction.PUBLISH), ("/teleop", "/joy", Direction.SUBSCRIBE)]
    parameter = NodeParameter(node="/pad", name="autorepeat_rate", value=rate)
    graph = InteractionGraph(
        app="app",
        ros=ros,
        nodes=(Node(name="/pad", package=package), Node(name="/teleop")),
        endpoints=tuple(
            Endpoint(node=node, topic=topic, type="sensor_msgs/Joy", direction=direction)
            for node, topic, direction in ends
        ),
        parameters=() if rate is None else (parameter,),
        wiring=(WiringFact(kind=WiringFactKind.LAST_MESSAGE, subject="/teleop", value=fate),),
    )
    found = [
        str(each) for each in silence_doubts(plan_of(grcn("/cmd_vel", ["/teleop"], [])), graph)
    ]
    told = (
        "/pad sends on change alone: a stick that is held is silent, and stops /teleop after 0.5 s"
    )
    help = "set its autorepeat_rate to 10 or more"
    assert found == [f"warning: GRCN grcn_cmd_vel: {told}; {help}"] * is_doubted
