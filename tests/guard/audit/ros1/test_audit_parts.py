"""The pure parts of the audit: rows, strangers, drift, and what one verification says."""

import pytest
from plans import grcn, plan_of

from rtron.errors import WireError
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import (
    NodeAddresses,
    PeerIdentity,
    foreign_connection_alarm,
    foreign_connections,
    parse_connections,
)
from rtron.guard.audit.ros1.registrations import (
    MasterRegistrations,
    drift_alarms,
    foreign_publisher_alarms,
    guarded_subscribers,
    select_registrations,
)
from rtron.guard.audit.ros1.verification import ApiAnswers, verify
from rtron.vocabulary import AlarmKind, Mode, StreamKind
from rtron.vocabulary.verification import PathState
from rtron.wire.ros1.ros_api import BusConnection, parse_bus_peers, parse_system_state

GUARD, PORT = "/rtron/grcn_cmd_vel", 4000
OURS, THEIRS = "http://here:1", "http://there:2"
OUT, FLOW = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"
PLAN = plan_of(grcn("/cmd_vel", ["/nav", "/teleop_*"], ["/driver", "/wheel_*"]))
EXPECTED = ExpectedGraph(PLAN)
ROSPY = "TCPROS connection on port 5 to [here:%d on socket 7]"
ROSCPP = "TCPROS connection on port 5 to [127.0.0.1:%d on socket 7]"


def row(source=OURS, topic=OUT, direction="i", info=ROSCPP % PORT, transport="TCPROS"):
    return [1, f"{source}/", direction, transport, topic, True, info]


def known(**others):
    found = NodeAddresses({GUARD: f"{OURS}/"}, frozenset({PORT}))
    for node, uri in others.items():
        found.learn(uri, f"/{node}")
    return found


def strangers(*rows, node="/driver", addresses=None):
    heard = EXPECTED.audited_topics(node)
    return foreign_connections(node, parse_connections(list(rows)), heard, addresses or known())


@pytest.mark.parametrize(
    ("info", "port"),
    [
        (ROSPY % 41234, 41234),
        (ROSCPP % 41234, 41234),
        ("TCPROS connection on port None to [None:None on socket None]", None),
        ("TCPROS connection on port 1 to [[::1]:7 on socket 3]", 7),
        ("TCPROS connection on port 1 to [host:7]", 7),
        ("INTRAPROCESS", None),
        ("", None),
        (f" to [{'x' * 999}:7]", None),
        (7, None),
        (None, None),
    ],
)
def test_the_port_at_the_other_end_is_read_as_both_libraries_write_it(info, port):
    (link,) = parse_connections([row(info=info)])
    assert link == BusConnection(OUT, OURS, port)


def test_what_goes_out_and_old_rows_without_an_info_are_no_surprise():
    assert parse_connections([row(direction="o")]) == frozenset()
    assert parse_connections([row(direction="b")]) == frozenset()
    assert parse_connections([row()[:6], row()[:5]]) == {BusConnection(OUT, OURS)}
    assert parse_connections([]) == frozenset()


@pytest.mark.parametrize(
    "rows",
    [
        None,
        "rows",
        7,
        {},
        [None],
        [[]],
        [["i"] * 4],
        [[1, 2, "i", "TCPROS", OUT]],
        [[1, "", "i", 1, 1]],
    ],
)
def test_rows_of_another_shape_are_refused(rows):
    with pytest.raises(WireError):
        parse_connections(rows)


def test_the_guard_and_the_supervisor_are_no_strangers():
    supervisor = known(rtron_supervisor=THEIRS)
    assert strangers(row(), row(THEIRS), addresses=supervisor) == frozenset()


@pytest.mark.parametrize(
    "rogue",
    [
        row(THEIRS),
        row(""),
        row("http://here:11"),
        row("http://HERE:1"),
        row(THEIRS, info=ROSCPP % PORT),
        row(info=ROSCPP % (PORT + 1)),
        row(THEIRS, transport="UDPROS"),
        row(THEIRS, topic="/cmd_vel"),
    ],
)
def test_whoever_else_is_heard_is_a_stranger(rogue):
    (found,) = strangers(row(), rogue)
    assert (found.node, found.guarded) == ("/driver", "/cmd_vel")


def test_a_connection_is_the_same_stranger_before_it_has_a_port_and_after():
    assert (
        strangers(row(THEIRS, info="")) == strangers(row(THEIRS)) == strangers(row(THEIRS, info=7))
    )


def test_a_planned_publisher_of_another_topic_is_a_stranger_here():
    assert strangers(row(THEIRS), addresses=known(nav=THEIRS))


def test_it_does_not_matter_what_is_heard_elsewhere_or_by_nodes_outside_the_plan():
    assert not strangers(row(THEIRS, topic="/scan"))
    assert not strangers(row(THEIRS), node="/rviz")
    assert not strangers(row(THEIRS, topic=FLOW))
    assert not strangers(row(THEIRS, topic=FLOW), node=GUARD)


def test_a_node_that_is_meant_by_a_pattern_is_guarded():
    assert strangers(row(THEIRS), node="/wheel_7")


def test_a_publisher_that_also_listens_hears_itself_and_the_guard_only():
    plan = plan_of(grcn("/cmd_vel", ["/loop"], ["/loop"]))
    heard = ExpectedGraph(plan).audited_topics("/loop")
    addresses = known(loop=THEIRS)
    rows = parse_connections(
        [row(topic=FLOW), row(THEIRS, topic=FLOW), row("http://x:1", topic=FLOW)]
    )
    (found,) = foreign_connections("/loop", rows, heard, addresses)
    assert found.connection.source == "http://x:1"


def test_where_the_plan_lets_strangers_through_the_public_name_is_open():
    plan = plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"], block_unapproved=False))
    heard = ExpectedGraph(plan).audited_topics("/driver")
    public, private = parse_connections([row(THEIRS, "/cmd_vel")]), parse_connections([row(THEIRS)])
    assert not foreign_connections("/driver", public, heard, known())
    assert foreign_connections("/driver", private, heard, known())


def test_an_address_is_learned_and_forgotten_but_never_for_our_own_names():
    addresses = known()
    addresses.learn(THEIRS, GUARD)
    assert addresses.node_of(BusConnection(OUT, THEIRS)) == ""
    addresses.learn(THEIRS, "/nav")
    assert addresses.node_of(BusConnection(OUT, THEIRS)) == "/nav"
    addresses.learn("http://new:3", "/nav")
    assert addresses.node_of(BusConnection(OUT, THEIRS)) == ""
    assert addresses.is_former(THEIRS)
    assert not addresses.is_former("http://new:3")
    addresses.learn(THEIRS, "/nav")
    assert not addresses.is_former(THEIRS)


@pytest.mark.parametrize(
    ("identity", "kind", "peer"),
    [
        (PeerIdentity(), AlarmKind.UNREGISTERED_PUBLISHER, THEIRS),
        (PeerIdentity(name="/rogue"), AlarmKind.FOREIGN_PUBLISHER, "/rogue"),
        (PeerIdentity(name=GUARD), AlarmKind.IMPOSTOR, GUARD),
        (PeerIdentity(name="/" + "x" * 9999), AlarmKind.FOREIGN_PUBLISHER, "/" + "x" * 199),
    ],
)
def test_an_alarm_says_what_kind_of_stranger_it_is(identity, kind, peer):
    (stranger,) = strangers(row(THEIRS))
    alarm = foreign_connection_alarm(stranger, identity, EXPECTED.guard_nodes)
    assert (alarm.kind, alarm.peer, alarm.node, alarm.topic) == (kind, peer, "/driver", OUT)
    assert len(alarm.reason) < 500


def listed(publishers=(), subscribers=()):
    sides = [[[topic, [node]] for topic, node in side] for side in (publishers, subscribers)]
    return select_registrations(parse_system_state([*sides, []]), EXPECTED.topics)


def test_a_node_that_registers_on_a_private_topic_is_foreign():
    fine = [(OUT, GUARD), (OUT, "/rtron_supervisor"), (FLOW, "/nav"), ("/cmd_vel", "/rogue")]
    assert not list(foreign_publisher_alarms(listed(fine), EXPECTED))
    for topic in (OUT, FLOW):
        (alarm,) = foreign_publisher_alarms(listed([*fine, (topic, "/rogue")]), EXPECTED)
        assert (alarm.kind, alarm.peer) == (AlarmKind.FOREIGN_PUBLISHER, "/rogue")
    assert list(foreign_publisher_alarms(listed([(FLOW, "/teleop_1")]), EXPECTED))


def test_many_foreign_nodes_make_a_bounded_number_of_alarms():
    many = [(topic, f"/rogue_{number}") for topic in (OUT, FLOW) for number in range(12_000)]
    assert len(list(foreign_publisher_alarms(listed([*many, (OUT, GUARD)]), EXPECTED))) == 2 * 16


def test_the_name_of_a_node_is_cut_where_the_master_lists_it():
    state = listed([(OUT, "/" + "x" * 999_999)], [(OUT, "/wheel_" + "x" * 999_999)])
    assert {len(name) for name in state.publishers[OUT] | state.subscribers[OUT]} == {256}
    assert list(foreign_publisher_alarms(state, EXPECTED))


def test_a_planned_node_on_the_public_name_has_drifted_and_a_stranger_there_has_not():
    assert not list(
        drift_alarms(listed([("/cmd_vel", "/rogue")], [("/cmd_vel", "/rviz")]), EXPECTED)
    )
    assert not list(drift_alarms(listed([("/cmd_vel", GUARD)], [("/cmd_vel", GUARD)]), EXPECTED))
    for publishers, subscribers in (
        ([("/cmd_vel", "/nav")], []),
        ([("/cmd_vel", "/teleop_3")], []),
        ([], [("/cmd_vel", "/driver")]),
        ([], [("/cmd_vel", "/wheel_1")]),
    ):
        (alarm,) = drift_alarms(listed(publishers, subscribers), EXPECTED)
        assert alarm.kind is AlarmKind.DRIFT
        assert alarm.node == (publishers or subscribers)[0][1]


def test_an_action_is_closed_in_both_directions():
    goal = grcn(
        "/act/goal",
        ["/client"],
        ["/server"],
        type="actionlib/TestActionGoal",
        kind=StreamKind.ACTION,
    )
    expected = ExpectedGraph(plan_of(goal))
    assert {"/server", "/client"} <= set(expected.listener_patterns())
    assert "/rtron/act/cancel/out" in expected.audited_topics("/server")
    assert "/rtron/act/result/out" in expected.audited_topics("/client")
    publishers = {"/act/status": frozenset({"/server"}), "/act/cancel": frozenset({"/client"})}
    found = drift_alarms(MasterRegistrations(publishers=publishers, subscribers={}), expected)
    assert {alarm.topic for alarm in found} == {"/act/status", "/act/cancel"}


def test_what_only_observes_expects_nothing():
    expected = ExpectedGraph(plan_of(grcn("/tf", ["/a"], ["/b"], mode=Mode.OBSERVE)))
    assert not expected.topics
    assert not list(expected.listener_patterns())


@pytest.mark.parametrize("state", [None, [], [[], []], "x", [[], [], [], []]])
def test_a_state_of_another_shape_is_refused(state):
    with pytest.raises(WireError):
        parse_system_state(state)


def test_malformed_rows_of_a_state_are_left_out():
    rows = [None, [], [OUT], [OUT, "x"], [7, []], [OUT, ["/a", 7, ""]], ["/other", ["/b"]]]
    state = select_registrations(parse_system_state([rows, None, 7]), EXPECTED.topics)
    assert state.publishers == {OUT: frozenset({"/a"})}
    assert state.subscribers == {}


def test_those_who_listen_are_guarded_and_others_are_not():
    state = listed(subscribers=[(OUT, "/driver"), ("/cmd_vel", "/rviz"), (FLOW, GUARD)])
    assert guarded_subscribers(state, EXPECTED) == {"/driver"}


def answers(rows, publishers=(), subscribers=((OUT, "/driver"),), **more):
    uris = {
        "/rtron_guard": f"{OURS}0/",
        "/rtron_bulk": f"{OURS}1/",
        GUARD: f"{OURS}/",
        "/rogue": f"{THEIRS}/",
    }
    given = {
        "state": listed([(OUT, GUARD), *publishers], subscribers),
        "uris": uris,
        "connections": {"/driver": parse_connections(rows)},
        "pids": {"/rtron_guard": 9, "/rtron_bulk": 7, GUARD: 9, "/nav": 7},
        "guard_parents": {"/rtron_guard": 5, "/rtron_bulk": 5, GUARD: 5},
    }
    return ApiAnswers(**given | more)


def state_of(verification, node="/driver"):
    (path,) = (path for path in verification.paths if path.node == node)
    return path.state, path.foreign


def test_a_closed_app_is_verified_if_all_of_it_was_seen():
    found = verify(PLAN, answers([row()], [(FLOW, "/nav")]))
    assert state_of(found) == (PathState.CLOSED, ())
    assert state_of(found, "/nav") == (PathState.CLOSED, ())
    assert state_of(found, "/wheel_*") == (PathState.NOT_SEEN, ())
    assert (found.is_closed, found.is_conclusive) == (False, False)
    assert found.without(["/wheel_*", "/teleop_*"]).is_closed


def test_a_publisher_that_the_master_still_lists_must_answer():
    found = verify(
        PLAN,
        answers([row()], [(FLOW, "/nav")], pids={"/rtron_guard": 9, "/rtron_bulk": 7, GUARD: 9}),
    )
    assert state_of(found, "/nav") == (PathState.UNKNOWN, ())


@pytest.mark.parametrize(
    ("given", "node", "reason"),
    [
        ({"guard_peers": frozenset({(OUT, "/driver")})}, "/driver", "the master does not list it"),
        ({"guard_peers": frozenset({(FLOW, "/nav")})}, "/nav", "the master does not list it"),
        ({"nodes": frozenset({"/driver"})}, "/driver", "uses neither /cmd_vel nor"),
        ({"nodes": frozenset({"/nav"})}, "/nav", "uses neither /cmd_vel nor"),
    ],
)
def test_a_node_that_was_seen_elsewhere_is_unknown_and_not_absent(given, node, reason):
    found = verify(PLAN, answers([], subscribers=(), connections={}, **given)).without(["*"])
    (path,) = (path for path in found.paths if path.node == node)
    assert path.state is PathState.UNKNOWN
    assert reason in path.reason


def test_whom_the_guards_nodes_are_connected_to():
    rows = [
        [1, "/driver", "o", "TCPROS", OUT, True, "1.2.3.4"],
        [2, "http://nav:1/", "i", "TCPROS", FLOW, True, "/nav"],
        [3, "http://x:1/", "i", "TCPROS", FLOW, True],
        [4, "", "o", "TCPROS", OUT, True, "/lies"],
    ]
    assert parse_bus_peers(rows) == {(OUT, "/driver"), (FLOW, "/nav")}
    for malformed in (None, [7], [[1, 2, "i", "TCPROS", OUT]]):
        with pytest.raises(WireError):
            parse_bus_peers(malformed)


@pytest.mark.parametrize(
    ("given", "state"),
    [
        (answers([row(), row(THEIRS)]), (PathState.OPEN, ("/rogue",))),
        (answers([row(), row("http://x:9")]), (PathState.OPEN, ("http://x:9",))),
        (answers([row(), row(THEIRS, "/cmd_vel")]), (PathState.OPEN, ("/rogue",))),
        (answers([]), (PathState.DRIFT, ())),
        (answers([row()], subscribers=[("/cmd_vel", "/driver")]), (PathState.DRIFT, ())),
    ],
)
def test_a_path_that_is_open_or_has_drifted_names_who_is_there(given, state):
    found = verify(PLAN, given)
    assert state_of(found) == state
    assert not found.is_closed
    assert found.is_conclusive


def test_a_node_that_does_not_answer_cannot_be_told():
    found = verify(PLAN, answers([], connections={}))
    assert state_of(found) == (PathState.UNKNOWN, ())
    assert (found.is_closed, found.is_conclusive) == (False, False)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"uris": {}}, "is not running"),
        ({"pids": {"/rtron_guard": 9}}, "does not answer"),
        ({"guard_parents": {"/rtron_guard": 5, GUARD: 8}}, "taken its name"),
        ({"guard_parents": {"/rtron_guard": 5, GUARD: 0}}, "taken its name"),
        ({"guard_parents": {"/rtron_guard": 5}}, f"{GUARD} did not answer who its parent is"),
        ({"guard_parents": {"/rtron_guard": 0, GUARD: 0}}, "whose the guard's nodes are is not"),
        ({"guard_parents": {GUARD: 5}}, "whose the guard's nodes are is not known"),
        ({"publishers": [(OUT, "/rogue")]}, "/rogue registered"),
    ],
)
def test_what_is_wrong_beside_the_paths_is_told(more, said):
    found = verify(PLAN, answers([row()], **more))
    assert any(said in problem for problem in found.problems)
    assert not found.is_closed


def test_what_is_not_guarded_is_listed():
    observed = grcn("/tf", ["/a"], ["/b"], mode=Mode.OBSERVE)
    plan = plan_of(*PLAN.grcn, observed, accept_unenforceable=("the plugin",))
    services = (
        ("/driver/set_parameters", "/driver"),
        ("/driver/enable", "/driver"),
        ("/driver/get_loggers", "/driver"),
        ("/map", "/map_server"),
    )
    found = verify(plan, answers([row()], services=services))
    whats = [each.what for each in found.unguarded]
    assert whats == ["/tf", "the plugin", "/driver/set_parameters", "/driver/enable"]
