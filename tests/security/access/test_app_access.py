"""Who may do what, by graph and plan."""

from dataclasses import replace

import pytest
from plans import grcn, plan_of

from rtron.errors import InputError
from rtron.security.access.app_access import app_access
from rtron.security.access.rights import AccessRight, RightKind
from rtron.vocabulary import (
    MSRCN,
    Action,
    ActionRole,
    Direction,
    Endpoint,
    EventFlow,
    InteractionGraph,
    LeaseGroup,
    Mode,
    Node,
    PolicyName,
    Service,
    ServiceClient,
    StopButton,
    StopSources,
    lease_topic,
    matches_node,
)

PUBLISH, SUBSCRIBE = RightKind.PUBLISH, RightKind.SUBSCRIBE
REPLY, REQUEST = RightKind.REPLY, RightKind.REQUEST
EXECUTE, CALL = RightKind.EXECUTE, RightKind.CALL
NAVIGATE = "nav2_msgs/action/NavigateToPose"


def publishes(node, topic, **more):
    return Endpoint(node=node, topic=topic, direction=Direction.PUBLISH, **more)


def subscribes(node, topic, **more):
    return Endpoint(node=node, topic=topic, direction=Direction.SUBSCRIBE, **more)


def graph_of(*entities, nodes=(), **more):
    kinds = {
        Endpoint: "endpoints",
        Service: "services",
        ServiceClient: "clients",
        Action: "actions",
    }
    lists = {name: tuple(e for e in entities if type(e) is cls) for cls, name in kinds.items()}
    named = dict.fromkeys(e.node for e in entities)
    listed = {node.name for node in nodes}
    nodes = (*nodes, *(Node(name=name) for name in named if name not in listed))
    return InteractionGraph(app="robot", ros=2, nodes=nodes, **lists, **more)


def drive(*publishers, **settings):
    return plan_of(grcn("/cmd_vel", publishers, ["/base"], **settings), app="robot", ros=2)


def rights_of(access, name):
    (process,) = (each for each in access if each.name == name)
    return process.rights


def doubts(access):
    return {(doubt.node, doubt.what) for doubt in access.doubts}


ROBOT = graph_of(
    publishes("/nav", "/cmd_vel"),
    publishes("/teleop", "/cmd_vel"),
    subscribes("/base", "/cmd_vel"),
    publishes("/base", "/odom"),
    subscribes("/nav", "/odom"),
)


def test_publishers_and_successors_have_private_names_and_the_guard_alone_the_output():
    access = app_access(ROBOT, drive("/nav", "/teleop"))
    of_robot = {process.name: process.names(PUBLISH) for process in access}
    assert "/rtron/cmd_vel/flow1" in of_robot["/nav"]
    assert "/rtron/cmd_vel/flow2" in of_robot["/teleop"]
    assert AccessRight(SUBSCRIBE, "/rtron/cmd_vel/out") in rights_of(access, "/base")
    allowed = [name for name, topics in of_robot.items() if "/rtron/cmd_vel/out" in topics]
    wide = [name for name, topics in of_robot.items() if any("*" in topic for topic in topics)]
    assert (allowed, wide) == ([], ["/rtron_guard", "/rtron_verify"])
    assert "/cmd_vel" not in of_robot["/nav"]
    assert "/cmd_vel" in of_robot["/rtron_guard"]
    assert rights_of(access, "/nav") >= {AccessRight(SUBSCRIBE, "/odom")}
    assert access.doubts == ()


def leased():
    """Return a plan whose publishers of velocities need a lease."""
    node = drive("/nav", "/teleop", policy=PolicyName.LEASE, lease="base")
    return replace(node, leases=(LeaseGroup(name="base"),))


def test_commanders_may_ask_for_their_lease_and_nobody_else():
    access = app_access(ROBOT, leased())
    request, answer, status = (
        lease_topic("base", each) for each in ("request", "answer", "status")
    )
    ways = {AccessRight(PUBLISH, request), *(AccessRight(SUBSCRIBE, t) for t in (answer, status))}
    assert rights_of(access, "/nav") >= ways
    assert rights_of(access, "/teleop") >= ways
    assert not rights_of(access, "/base") & ways
    assert access.doubts == ()


def test_who_is_seen_to_ask_for_a_lease_of_others_is_told():
    asking = [publishes(node, lease_topic("base", "request")) for node in ("/nav", "/base")]
    seen = replace(ROBOT, endpoints=(*ROBOT.endpoints, *asking))
    access = app_access(seen, leased())
    assert doubts(access) == {("/base", f"publish {lease_topic('base', 'request')}")}


def test_a_stop_button_may_be_pressed_by_its_node_and_heard_by_the_guard():
    button = StopButton(name="red", topic="/estop", publisher="/estop_driver")
    plan = replace(drive("/nav", "/teleop"), stop_sources=StopSources(buttons=(button,)))
    access = app_access(ROBOT, plan)
    assert AccessRight(PUBLISH, "/estop") in rights_of(access, "/estop_driver")
    assert AccessRight(SUBSCRIBE, "/estop") in rights_of(access, "/rtron_guard")


def test_a_node_gets_what_its_client_library_needs_and_nobody_may_set_its_parameters():
    access = app_access(ROBOT, drive("/nav", "/teleop"), operator=True)
    rights = rights_of(access, "/nav")
    assert {
        AccessRight(PUBLISH, "/rosout"),
        AccessRight(PUBLISH, "/parameter_events"),
        AccessRight(SUBSCRIBE, "/parameter_events"),
        AccessRight(SUBSCRIBE, "/clock"),
        AccessRight(REPLY, "/nav/set_parameters"),
        AccessRight(REPLY, "/nav/get_type_description"),
    } <= rights
    requests = [name for process in access.processes[1:] for name in process.names(REQUEST)]
    assert not [name for name in requests if "set_parameters" in name]


def test_who_publishes_without_a_flow_is_refused_and_told():
    access = app_access(ROBOT, drive("/nav"))
    assert doubts(access) == {("/teleop", "publish /cmd_vel")}
    assert not any("cmd_vel" in name for name in of_kind(access, "/teleop", PUBLISH))


def of_kind(access, name, kind):
    return {right.name for right in rights_of(access, name) if right.kind is kind}


def test_strangers_may_publish_where_the_plan_lets_them():
    access = app_access(ROBOT, drive("/nav", block_unapproved=False))
    assert AccessRight(PUBLISH, "/cmd_vel") in rights_of(access, "/teleop")


def test_an_observed_stream_moves_nothing():
    access = app_access(ROBOT, drive("/nav", mode=Mode.OBSERVE))
    assert AccessRight(PUBLISH, "/cmd_vel") in rights_of(access, "/nav")
    assert "/cmd_vel" not in of_kind(access, "/rtron_guard", PUBLISH)


def test_a_successor_that_publishes_without_a_flow_may_not_reach_the_output():
    graph = graph_of(publishes("/base", "/cmd_vel"), subscribes("/base", "/cmd_vel"))
    access = app_access(graph, drive("/nav"))
    assert ("/base", "publish /cmd_vel") in doubts(access)
    assert not any("cmd_vel" in name for name in of_kind(access, "/base", PUBLISH))


def test_a_successor_with_a_flow_has_one_name_for_both():
    graph = graph_of(publishes("/base", "/cmd_vel"), subscribes("/base", "/cmd_vel"))
    access = app_access(graph, drive("/nav", "/base"))
    both = {AccessRight(kind, "/rtron/cmd_vel/flow2") for kind in (PUBLISH, SUBSCRIBE)}
    assert both <= rights_of(access, "/base")
    assert not any(right.name.endswith("/out") for right in rights_of(access, "/base"))


def test_actions_move_as_one():
    graph = graph_of(
        Action(node="/tasks", name="/go", type=NAVIGATE, role=ActionRole.CLIENT),
        Action(node="/other", name="/go", type=NAVIGATE, role=ActionRole.CLIENT),
        Action(node="/nav", name="/go", type=NAVIGATE, role=ActionRole.SERVER),
        Action(node="/nav", name="/spin", type="nav2_msgs/action/Spin", role=ActionRole.SERVER),
    )
    plan = plan_of(grcn("/go", ["/tasks"], ["/nav"], type=NAVIGATE), ros=2)
    access = app_access(graph, plan)
    assert of_kind(access, "/tasks", CALL) == {"/rtron/go/flow1"}
    assert of_kind(access, "/nav", EXECUTE) == {"/rtron/go/out", "/spin"}
    assert of_kind(access, "/other", CALL) == set()
    assert ("/other", "call /go") in doubts(access)
    assert AccessRight(EXECUTE, "/go") in rights_of(access, "/rtron_guard")


def test_services_are_offered_by_one_and_called_by_the_other():
    graph = graph_of(
        Service(node="/map_server", name="/map_server/load"),
        ServiceClient(node="/ui", name="/map_server/load"),
    )
    access = app_access(graph, drive("/nav"))
    assert AccessRight(REPLY, "/map_server/load") in rights_of(access, "/map_server")
    assert AccessRight(REQUEST, "/map_server/load") in rights_of(access, "/ui")


def test_components_share_the_enclave_of_their_container_which_launch_may_load():
    load = Service(
        node="/box", name="/box/_container/load_node", type="composition_interfaces/srv/LoadNode"
    )
    graph = graph_of(
        publishes("/nav", "/cmd_vel"),
        subscribes("/eyes", "/image"),
        load,
        nodes=(Node(name="/nav", process="/box"), Node(name="/eyes", process="/box")),
    )
    access = app_access(graph, drive("/nav"))
    (box,) = (each for each in access if each.name == "/box")
    assert [node.node for node in box.nodes] == ["/nav", "/eyes", "/box"]
    assert {
        AccessRight(PUBLISH, "/rtron/cmd_vel/flow1"),
        AccessRight(SUBSCRIBE, "/image"),
    } <= box.rights
    assert AccessRight(REQUEST, "/box/_container/load_node") in rights_of(access, "/")


def test_the_nodes_of_one_participant_are_one_process():
    one, other = "ab" * 12, "cd" * 12
    graph = graph_of(
        publishes("/a", "/x", gid=f"{one}00000103"),
        publishes("/b", "/y", gid=f"{one}00000203"),
        publishes("/c", "/z", gid=f"{other}00000103"),
    )
    access = app_access(graph, drive("/nav"))
    assert [process.name for process in access][2:] == ["/a", "/base", "/c", "/nav"]


@pytest.mark.parametrize("name", ["/*", "/sc?n", "/{name}/scan", "/a//b", "scan", "/a<b", "/ä"])
def test_a_name_that_is_not_known_is_allowed_to_nobody(name):
    access = app_access(graph_of(subscribes("/viewer", name)), drive("/nav"))
    assert ("/viewer", f"subscribe {name}") in doubts(access)
    assert name not in of_kind(access, "/viewer", SUBSCRIBE)


@pytest.mark.parametrize("node", ["/*", "/{robot}/nav", "/a b", "/../x", "/_ros2cli_1", "/x*/y"])
def test_a_node_without_a_known_name_gets_no_enclave(node):
    access = app_access(graph_of(publishes(node, "/odom")), drive("/nav"))
    assert node in {who for who, _ in doubts(access)}
    assert [process.name for process in access][2:] == ["/base", "/nav"]


def test_an_anonymous_node_has_an_enclave_for_all_of_its_names():
    graph = graph_of(publishes("/teleop_17", "/cmd_vel"))
    access = app_access(graph, drive("/teleop_*"))
    assert AccessRight(PUBLISH, "/rtron/cmd_vel/flow1") in rights_of(access, "/teleop_17")
    absent = app_access(graph_of(), drive("/teleop_*"))
    assert AccessRight(REPLY, "/teleop_*/get_parameters") in rights_of(absent, "/teleop_any")
    assert ("/teleop_*", "the node") in doubts(absent)


@pytest.mark.parametrize("pattern", ["/r*", "/rtron_*", "/rtron*", "/*"])
def test_a_pattern_does_not_get_the_services_of_the_guards_nodes(pattern):
    access = app_access(ROBOT, drive("/nav", pattern))
    replies = {name for each in access.processes[2:] for name in each.names(REPLY)}
    assert not any(matches_node(name, "/rtron_guard/set_parameters") for name in replies)
    absent = app_access(graph_of(), drive(pattern))
    assert (pattern, "the node") in doubts(absent)


def test_the_graph_of_a_guarded_app_gives_the_same_rights():
    guarded = graph_of(
        publishes("/nav", "/rtron/cmd_vel/flow1"),
        publishes("/rtron/grcn_cmd_vel", "/rtron/cmd_vel/out"),
        publishes("/rtron/grcn_cmd_vel", "/cmd_vel"),
        subscribes("/base", "/rtron/cmd_vel/out"),
    )
    own = graph_of(publishes("/nav", "/cmd_vel"), subscribes("/base", "/cmd_vel"))
    plan = drive("/nav")
    assert app_access(guarded, plan).processes == app_access(own, plan).processes
    assert app_access(guarded, plan).doubts == ()


def test_an_intruder_of_a_running_app_gets_nothing_of_the_plans():
    graph = graph_of(publishes("/evil", "/rtron/cmd_vel/out"), publishes("/evil", "/noise"))
    access = app_access(graph, drive("/nav"))
    assert ("/evil", "publish /rtron/cmd_vel/out") in doubts(access)
    assert {n for n in of_kind(access, "/evil", PUBLISH) if "rtron" in n} == set()


def test_a_node_that_is_known_in_part_is_told():
    graph = graph_of(nodes=(Node(name="/blob", unread=True),))
    access = app_access(graph, drive("/nav"))
    assert ("/blob", "the node") in doubts(access)
    assert of_kind(access, "/blob", PUBLISH) == {"/rosout", "/parameter_events"}


def test_events_are_published_by_whom_the_plan_says_and_read_by_the_guard():
    event = EventFlow(name="fire", topic="/fire", publisher="/alarm")
    msrcn = MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, eflows=(event,))
    access = app_access(graph_of(), plan_of(msrcn=msrcn, ros=2))
    assert AccessRight(PUBLISH, "/fire") in rights_of(access, "/alarm")
    assert AccessRight(SUBSCRIBE, "/fire") in rights_of(access, "/rtron_guard")


def test_a_process_cannot_take_the_guards_enclave():
    graph = graph_of(publishes("/evil", "/x"), nodes=(Node(name="/evil", process="/rtron_guard"),))
    with pytest.raises(InputError, match="RTron's own"):
        app_access(graph, drive("/nav"))


def test_ros_1_is_refused():
    with pytest.raises(InputError, match="ROS 1"):
        app_access(InteractionGraph(app="a"), drive("/nav"))
