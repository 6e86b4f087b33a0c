"""What `rtron verify --live` makes of a ROS 2 domain: every planned path, by participants."""

from dataclasses import replace

import pytest
from domain_scene import (
    CANCEL_GOAL,
    CLOSED,
    CMD_VEL,
    DRIVER,
    DRIVER_SUBSCRIBES,
    FLOW1,
    FLOW2,
    GRCN,
    GUARD,
    GUARDS,
    NAV,
    NAV_PUBLISHES,
    NAVIGATE,
    NAVIGATE_GRCN,
    NODES,
    OUT,
    ROGUE,
    SEND_GOAL,
    TELEOP,
    action_plan,
    base_plan,
    client_endpoint,
    path_of,
    publisher,
    server_endpoints,
    subscriber,
    verified,
)

from rtron.guard.audit.ros2.observed_graph import ObservedGraph
from rtron.guard.audit.ros2.verification import verify_ros2_cell
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    STOPPER_NODE,
    SUPERVISOR_NODE,
    Durability,
    Liveliness,
    Mode,
    QoS,
    Reliability,
    StreamKind,
)
from rtron.vocabulary.verification import PathState

OPEN, DRIFT = PathState.OPEN, PathState.DRIFT
SPEAKS_OUT = publisher(OUT, "/rogue", ROGUE)


def states(verification):
    return {path.node: path.state for path in verification.paths}


CELLED = replace(base_plan(), cell=("/driver",))
INSIDE = (publisher(OUT, GRCN, GUARD), publisher(OUT, STOPPER_NODE, TELEOP), DRIVER_SUBSCRIBES)


def inside_cell(*ends):
    return path_of(verify_ros2_cell(CELLED, ObservedGraph((*INSIDE, *ends))), "/driver")


def test_in_a_cell_the_driver_hears_the_guard_and_the_stopper():
    assert inside_cell().state is PathState.CLOSED


def test_in_a_cell_somebody_else_is_heard_past_the_guard():
    path = inside_cell(SPEAKS_OUT)
    assert (path.state, path.foreign) == (OPEN, ("/rogue",))


def test_in_a_cell_a_type_that_the_guard_does_not_publish_is_drift():
    path = inside_cell(subscriber(OUT, "/driver", DRIVER, type="geometry_msgs/msg/TwistStamped"))
    assert path.state is DRIFT


def test_a_closed_app():
    found = verified()
    assert states(found) == {
        "/driver": PathState.CLOSED,
        "/nav": PathState.CLOSED,
        "/teleop_*": PathState.ABSENT,
    }
    assert (found.is_closed, found.is_conclusive, found.problems) == (True, True, ())
    assert {(path.topic, path.private) for path in found.paths} == {
        (CMD_VEL, OUT),
        (CMD_VEL, FLOW1),
        (CMD_VEL, FLOW2),
    }


def test_what_was_not_seen_is_not_closed():
    found = verified(absent=())
    assert found.not_seen == ("/teleop_*",)
    assert (found.is_closed, found.is_conclusive) == (False, False)
    found = verified(GUARDS, NODES[:3], absent=())
    assert found.not_seen == ("/driver", "/nav", "/teleop_*")
    assert (found.is_closed, found.is_conclusive, found.problems) == (False, False, ())


def test_a_guard_that_has_not_spoken_yet_is_closed():
    ends = [end for end in CLOSED if end != GUARDS[0]]
    assert verified(ends).is_closed


def test_a_pattern_means_each_node_of_its_kind():
    teleops = [publisher(FLOW2, f"/teleop_{n}", TELEOP) for n in (1, 2)]
    found = verified([*CLOSED, *teleops], [*NODES, "/teleop_1", "/teleop_2"])
    assert path_of(found, "/teleop_1").state is PathState.CLOSED
    assert path_of(found, "/teleop_2").state is PathState.CLOSED


@pytest.mark.parametrize(
    ("more", "who"),
    [
        (SPEAKS_OUT, "/rogue"),
        (publisher(OUT, "/nav", NAV), "/nav"),
        (publisher(OUT, "", ROGUE), "GID "),
        (publisher(OUT, GRCN, ROGUE), f"{GRCN} of the participant {ROGUE.hex()}"),
        (publisher(OUT, GUARD_NODE, ROGUE), f"{GUARD_NODE} of the participant"),
    ],
)
def test_who_speaks_on_the_private_output_beside_the_guard_opens_it(more, who):
    found = verified([*CLOSED, more])
    path = path_of(found, "/driver")
    assert path.state is OPEN
    assert len(path.foreign) == 1
    assert path.foreign[0].startswith(who)
    assert not found.is_closed
    assert found.is_conclusive


def test_an_endpoint_of_the_guard_is_its_own_whatever_node_it_is_given_to():
    assert verified([*CLOSED, replace(publisher(OUT, "", GUARD), gid=GUARD + b"late")]).is_closed


def test_the_supervisor_may_speak_and_a_second_one_not():
    one = publisher(OUT, SUPERVISOR_NODE, TELEOP)
    assert verified([*CLOSED, one]).is_closed
    found = verified([*CLOSED, one, publisher(OUT, SUPERVISOR_NODE, ROGUE)])
    assert path_of(found, "/driver").state is OPEN
    assert [SUPERVISOR_NODE in problem for problem in found.problems] == [True]


def test_a_second_guard_is_named_as_a_problem_although_nobody_hears_it():
    found = verified([*GUARDS, publisher("/rosout", GRCN, ROGUE)])
    assert found.problems == (f"{ROGUE.hex()} has the name of the guard's node {GRCN}",)
    assert not found.is_closed


def test_a_second_node_of_the_guard_without_an_endpoint_is_found_by_the_list_of_nodes():
    assert verified(nodes=[*NODES, GUARD_NODE]).problems == ()
    found = verified(nodes=[*NODES, GUARD_NODE, GUARD_NODE])
    assert found.problems == (f"3 nodes have the name of the guard's node {GUARD_NODE}",)
    supervised = [*NODES, GUARD_NODE, GUARD_NODE, SUPERVISOR_NODE]
    assert verified(nodes=supervised).is_closed
    assert not verified(nodes=[*supervised, GUARD_NODE]).is_closed
    assert not verified(nodes=[*supervised, GRCN]).is_closed


def test_a_guard_that_is_not_there_is_a_problem():
    found = verified([NAV_PUBLISHES, DRIVER_SUBSCRIBES], ["/nav", "/driver"])
    assert found.problems == (
        f"the guard's node {GRCN} is not running",
        f"the guard's node {BULK_NODE} is not running",
        f"the guard's node {GUARD_NODE} is not running",
    )


def test_a_stranger_on_an_output_that_nobody_hears_is_a_problem():
    tool = subscriber(OUT, "/rosbag", TELEOP)
    for ends in ([*GUARDS, SPEAKS_OUT], [*GUARDS, SPEAKS_OUT, tool]):
        assert verified(ends).problems == (f"/rogue speaks on the private {OUT}",)


def test_a_stranger_on_the_public_name_is_the_guards_business():
    assert verified([*CLOSED, publisher(CMD_VEL, "/rogue", ROGUE)]).is_closed


def test_a_successor_on_the_public_name_has_drifted():
    for ends in (GUARDS, (*GUARDS, DRIVER_SUBSCRIBES)):
        path = path_of(verified([*ends, subscriber(CMD_VEL, "/driver", DRIVER)]), "/driver")
        assert path.state is DRIFT
        assert path.reason == f"listens to {CMD_VEL}: its remap is missing"


def test_a_successor_on_the_public_name_hears_strangers_there():
    ends = [*GUARDS, subscriber(CMD_VEL, "/driver", DRIVER), publisher(CMD_VEL, "/rogue", ROGUE)]
    assert path_of(verified(ends), "/driver").foreign == ("/rogue",)
    assert path_of(verified(ends), "/driver").state is OPEN
    waved_through = base_plan(block_unapproved=False)
    assert path_of(verified(ends, plan=waved_through), "/driver").state is DRIFT


def test_a_publisher_on_the_public_name_has_drifted():
    found = verified([*GUARDS, publisher(CMD_VEL, "/nav", NAV), DRIVER_SUBSCRIBES])
    assert states(found) == {
        "/driver": PathState.CLOSED,
        "/nav": DRIFT,
        "/teleop_*": PathState.ABSENT,
    }


def test_a_stranger_on_a_flow_opens_it_although_its_node_does_not_run():
    found = verified([*CLOSED, publisher(FLOW2, "/rogue", ROGUE)])
    path = path_of(found, "/teleop_*")
    assert (path.state, path.foreign) == (OPEN, ("/rogue",))
    assert path_of(found, "/nav").state is PathState.CLOSED


def test_a_flows_node_is_nobody_on_another_flow():
    path = path_of(verified([*CLOSED, publisher(FLOW1, "/teleop_1", TELEOP)]), "/nav")
    assert (path.state, path.foreign) == (OPEN, ("/teleop_1",))


@pytest.mark.parametrize("topic", [FLOW1, "/rosout", CMD_VEL])
def test_two_participants_of_a_publishers_name_open_its_flow(topic):
    path = path_of(verified([*CLOSED, publisher(topic, "/nav", ROGUE)]), "/nav")
    assert path.state is OPEN
    assert {each.split()[-1] for each in path.foreign} == {NAV.hex(), ROGUE.hex()}


def test_who_only_listens_is_noted():
    found = verified([*CLOSED, *(subscriber(t, "/rosbag", ROGUE) for t in (OUT, FLOW1))])
    assert found.is_closed
    assert path_of(found, "/driver").reason == "/rosbag listens, too"
    assert path_of(found, "/nav").reason == "/rosbag listens, too"


def test_a_nameless_listener_may_be_the_successor():
    path = path_of(verified([*GUARDS, subscriber(OUT, "", DRIVER)]), "/driver")
    assert path.state is PathState.UNKNOWN
    assert not verified([*GUARDS, subscriber(OUT, "", DRIVER)]).is_conclusive


def test_a_node_that_runs_and_has_nothing_of_the_plan_is_told_so():
    found = verified(GUARDS)
    assert {path.node: path.reason for path in found.paths} == {
        "/driver": "it runs, and listens to neither name",
        "/nav": "it runs, and speaks on neither name",
        "/teleop_*": "",
    }
    assert states(found) == {
        "/driver": PathState.UNKNOWN,
        "/nav": PathState.UNKNOWN,
        "/teleop_*": PathState.ABSENT,
    }
    assert not found.is_conclusive


@pytest.mark.parametrize(
    ("offered", "opened_sources", "why"),
    [
        (QoS(reliability=Reliability.BEST_EFFORT), QoS(), "reliable is asked for"),
        (QoS(), QoS(durability=Durability.TRANSIENT_LOCAL), "transient local is asked for"),
        (QoS(), QoS(liveliness=Liveliness.MANUAL_BY_TOPIC), "liveliness by topic is asked for"),
        (QoS(), QoS(deadline=10**6), "a deadline of 1 ms is asked for, none is offered"),
        (QoS(lease=2 * 10**6), QoS(lease=10**6), "a lease of the liveliness of 1 ms is asked"),
    ],
)
def test_a_successor_that_asks_for_more_than_the_guard_offers_has_drifted(
    offered, opened_sources, why
):
    ends = [
        *GUARDS[1:],
        replace(GUARDS[0], qos=offered),
        replace(DRIVER_SUBSCRIBES, qos=opened_sources),
    ]
    path = path_of(verified(ends), "/driver")
    assert path.state is DRIFT
    assert path.reason.startswith(f"does not hear the guard: {why}")


@pytest.mark.parametrize(
    ("offered", "opened_sources"),
    [
        (QoS(), QoS(reliability=Reliability.BEST_EFFORT)),
        (QoS(durability=Durability.TRANSIENT_LOCAL), QoS()),
        (QoS(liveliness=Liveliness.MANUAL_BY_TOPIC), QoS()),
        (QoS(deadline=5, lease=5), QoS(deadline=5, lease=5)),
        (QoS(deadline=5, lease=5), QoS()),
        (QoS(depth=1, lifespan=1), QoS(depth=9)),
    ],
)
def test_a_successor_that_asks_for_less_is_served(offered, opened_sources):
    ends = [
        *GUARDS[1:],
        replace(GUARDS[0], qos=offered),
        replace(DRIVER_SUBSCRIBES, qos=opened_sources),
    ]
    assert path_of(verified(ends), "/driver").state is PathState.CLOSED


def test_another_type_is_drift_on_both_sides():
    other = "std_msgs/msg/String"
    path = path_of(verified([*GUARDS, replace(DRIVER_SUBSCRIBES, type=other)]), "/driver")
    assert path.reason.endswith("geometry_msgs/Twist is published, std_msgs/String is asked for")
    silent = [*GUARDS[1:], replace(DRIVER_SUBSCRIBES, type=other)]
    assert path_of(verified(silent), "/driver").state is DRIFT
    path = path_of(verified([*GUARDS, replace(NAV_PUBLISHES, type=other)]), "/nav")
    assert path.state is DRIFT
    assert path.reason.endswith("its type is std_msgs/String, the plan's is geometry_msgs/Twist")


def test_one_subscription_of_two_that_hears_nothing_is_drift():
    other = replace(DRIVER_SUBSCRIBES, gid=DRIVER + b"more", type="std_msgs/msg/String")
    for ends in ([DRIVER_SUBSCRIBES, other], [other, DRIVER_SUBSCRIBES]):
        assert path_of(verified([*GUARDS, *ends]), "/driver").state is DRIFT


def test_what_is_only_observed_has_no_paths():
    found = verified(plan=base_plan(mode=Mode.OBSERVE))
    assert found.paths == ()
    assert [each.what for each in found.unguarded] == [CMD_VEL]


SERVED = tuple(
    end
    for part in (SEND_GOAL, CANCEL_GOAL)
    for end in (
        *server_endpoints(NAVIGATE, part, NAVIGATE_GRCN, GUARD),
        *server_endpoints(f"/rtron{NAVIGATE}/flow1", part, NAVIGATE_GRCN, GUARD),
        *server_endpoints(f"/rtron{NAVIGATE}/out", part, "/server", DRIVER),
        client_endpoint(f"/rtron{NAVIGATE}/out", part, NAVIGATE_GRCN, GUARD),
        client_endpoint(f"/rtron{NAVIGATE}/flow1", part, "/mission", NAV),
    )
)
ACTORS = (GUARD_NODE, BULK_NODE, NAVIGATE_GRCN, "/mission", "/server")


def acting(*more, without=()):
    ends = [end for end in SERVED if end not in without]
    return verified([*ends, *more], ACTORS, plan=action_plan())


def test_a_closed_action_is_shown_by_its_services_names():
    found = acting()
    assert found.is_closed
    assert found.problems == ()
    private = f"/rtron{NAVIGATE}/out{SEND_GOAL}"
    assert (f"{NAVIGATE}{SEND_GOAL}", private) in {(p.topic, p.private) for p in found.paths}
    assert {path.state for path in found.paths} == {PathState.CLOSED}


@pytest.mark.parametrize("part", [SEND_GOAL, CANCEL_GOAL])
def test_a_client_beside_the_guard_opens_the_servers_path(part):
    found = acting(client_endpoint(f"/rtron{NAVIGATE}/out", part, "/rogue", ROGUE))
    (path,) = (path for path in found.paths if path.state is OPEN)
    assert (path.node, path.foreign) == ("/server", ("/rogue",))


def test_a_client_of_the_public_name_is_the_guards_business_unless_the_server_is_there():
    outside = client_endpoint(NAVIGATE, SEND_GOAL, "/rogue", ROGUE)
    assert acting(outside).is_closed
    found = acting(outside, *server_endpoints(NAVIGATE, SEND_GOAL, "/server", DRIVER))
    (path,) = (path for path in found.paths if path.state is OPEN)
    assert (path.node, path.topic) == ("/server", f"{NAVIGATE}{SEND_GOAL}")
    alone = acting(*server_endpoints(NAVIGATE, SEND_GOAL, "/server", DRIVER))
    assert {path.state for path in alone.paths} == {PathState.CLOSED, DRIFT}


def test_a_stranger_that_answers_in_the_servers_place_is_a_problem():
    found = acting(*server_endpoints(f"/rtron{NAVIGATE}/out", SEND_GOAL, "/rogue", ROGUE))
    assert found.problems == (f"/rogue speaks on the private /rtron{NAVIGATE}/out{SEND_GOAL}",)
    told = acting(publisher(f"/rtron{NAVIGATE}/out/_action/status", "/rogue", ROGUE))
    assert len(told.problems) == 1


def test_where_nothing_is_to_be_stopped_the_supervisor_has_no_node_of_its_own():
    plan, told = action_plan(), f"nodes have the name of the guard's node {GUARD_NODE}"
    goals = replace(plan, grcn=tuple(replace(g, kind=StreamKind.ACTION) for g in plan.grcn))
    assert verified(SERVED, [*ACTORS, GUARD_NODE, GUARD_NODE], plan=goals).problems == ()
    fourth = verified(SERVED, [*ACTORS, *3 * [GUARD_NODE]], plan=goals)
    assert fourth.problems == (f"4 {told}",)
