"""Which alarms follow from what a ROS 2 domain shows, and which streams they brake."""

from dataclasses import replace
from itertools import chain
from pathlib import Path
from tempfile import mkdtemp
from types import SimpleNamespace

import pytest
from domain_scene import (
    CLOSED,
    CMD_VEL,
    DRIVER,
    FLOW1,
    GRCN,
    GUARD,
    GUARDS,
    NAV,
    NAV_PUBLISHES,
    NAVIGATE,
    NAVIGATE_GRCN,
    OUT,
    ROGUE,
    SEND_GOAL,
    TELEOP,
    action_plan,
    base_plan,
    client_endpoint,
    publisher,
    server_endpoints,
    subscriber,
)
from proc_folder import ProcFolder

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.audit.common.debounced_alarms import BrakingAlarm, BrakingAlarms
from rtron.guard.audit.ros2.endpoint_checks import planned_publishers
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.graph_alarms import (
    NAME_TIMEOUT,
    drift_alarms,
    duplicate_name_alarms,
    foreign_endpoint_alarms,
)
from rtron.guard.audit.ros2.observed_graph import ObservedGraph
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.intrusion_latch import IntrusionLatch
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.ros2.participants import MAX_LEASE, ParticipantLiveness
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    SUPERVISOR_NODE,
    Alarm,
    AlarmKind,
    OnForeign,
    QoS,
    Reliability,
    build_streams,
)

OURS = frozenset({GUARD})
ACTION_OUT = f"/rtron{NAVIGATE}/out"
ACTION_STATUS = f"{ACTION_OUT}/_action/status"
RUNNING = {1000, 2000, 3000, 4000, 5000}


class GraphAudit:
    """What the audit makes of endpoints, look by look."""

    folder = ""

    def __init__(self, plan=None, running=RUNNING, own=GUARD):
        self.wanted = ExpectedGraph(plan or base_plan())
        self.machine = ProcFolder(Path(mkdtemp(dir=self.folder)))
        for pid in running:
            self.machine.start(pid)
        self.lives = ParticipantLiveness(own, self.machine.processes())

    def at(self, now, *ends):
        seen = ObservedGraph(ends)
        self.lives.update((end.participant for end in ends), now)
        found = foreign_endpoint_alarms(self.wanted, seen, OURS, self.lives, now)
        found += duplicate_name_alarms(self.wanted, seen, self.lives, now)
        return [(each.alarm, each.streams) for each in found]


@pytest.fixture(autouse=True)
def _machines(tmp_path, monkeypatch):
    monkeypatch.setattr(GraphAudit, "folder", tmp_path)


def found(*ends, plan=None):
    return GraphAudit(plan).at(0, *ends)


def test_a_closed_app_gives_no_alarm():
    assert found(*CLOSED) == []
    assert list(drift_alarms(ExpectedGraph(base_plan()), ObservedGraph(CLOSED), OURS)) == []


def test_a_stranger_on_the_private_output_is_told_and_braked_at_once():
    ((alarm, braked),) = found(*CLOSED, publisher(OUT, "/rogue", ROGUE))
    assert (alarm.kind, alarm.topic, alarm.peer) == (AlarmKind.FOREIGN_PUBLISHER, OUT, "/rogue")
    assert alarm.reason == (
        f"/rogue of the participant {ROGUE.hex()} publishes {OUT}, past the guard"
    )
    assert braked == (CMD_VEL,)


def test_a_stranger_where_the_driver_is_in_a_cell_is_told_and_brakes_nothing():
    celled = replace(base_plan(), cell=("/driver",))
    outside = (*GUARDS[1:], NAV_PUBLISHES)
    ((alarm, braked),) = found(*outside, publisher(OUT, "/rogue", ROGUE), plan=celled)
    assert (alarm.kind, alarm.peer, braked) == (AlarmKind.FOREIGN_PUBLISHER, "/rogue", ())


def test_a_nameless_one_on_the_private_output_is_a_ghost_at_once():
    ((alarm, braked),) = found(*CLOSED, publisher(OUT, "", ROGUE))
    assert (alarm.kind, braked) == (AlarmKind.UNREGISTERED_PUBLISHER, (CMD_VEL,))


def test_where_gids_tell_no_process_a_nameless_one_may_be_the_supervisor_for_a_moment():
    look, nameless = GraphAudit(own=b"\x01\x10" + GUARD[2:]), publisher(OUT, "", ROGUE)
    assert look.at(0, *CLOSED, nameless) == []
    ((alarm, braked),) = look.at(NAME_TIMEOUT + 1, *CLOSED, nameless)
    assert (alarm.kind, braked) == (AlarmKind.UNREGISTERED_PUBLISHER, (CMD_VEL,))


def test_a_planned_publisher_is_a_stranger_on_the_output():
    ((alarm, braked),) = found(*CLOSED, publisher(OUT, "/nav", NAV))
    assert (alarm.peer, braked) == ("/nav", (CMD_VEL,))


def test_a_stranger_on_a_flow_is_told_and_brakes_nothing_since_the_guard_refuses_it():
    ((alarm, braked),) = found(*CLOSED, publisher(FLOW1, "/rogue", ROGUE))
    assert (alarm.kind, braked) == (AlarmKind.FOREIGN_PUBLISHER, ())
    assert alarm.reason.endswith("where the guard does not hear it")


def test_a_nameless_one_on_a_flow_has_a_moment_to_be_named():
    look, nameless = GraphAudit(), publisher(FLOW1, "", ROGUE)
    assert look.at(0, *CLOSED, nameless) == []
    assert look.at(NAME_TIMEOUT, *CLOSED, nameless) == []
    ((alarm, braked),) = look.at(NAME_TIMEOUT + 1, *CLOSED, nameless)
    assert (alarm.kind, braked) == (AlarmKind.UNREGISTERED_PUBLISHER, ())


def test_strangers_on_the_public_name_matter_only_where_a_successor_listens_there():
    rogue = publisher(CMD_VEL, "/rogue", ROGUE)
    tool = subscriber(CMD_VEL, "/rviz", TELEOP)
    assert found(*CLOSED, rogue, tool) == []
    ((alarm, braked),) = found(*CLOSED, rogue, subscriber(CMD_VEL, "/driver", DRIVER))
    assert (alarm.peer, alarm.topic, braked) == ("/rogue", CMD_VEL, (CMD_VEL,))
    waved = base_plan(block_unapproved=False)
    assert found(*CLOSED, rogue, subscriber(CMD_VEL, "/driver", DRIVER), plan=waved) == []


@pytest.mark.parametrize("topic", ["/rosout", CMD_VEL, FLOW1, OUT])
def test_a_name_of_ours_with_somebody_else_is_an_impostor_wherever_it_is(topic):
    ((alarm, braked),) = found(*CLOSED, publisher(topic, GRCN, ROGUE))
    assert (alarm.kind, alarm.node, alarm.peer) == (AlarmKind.IMPOSTOR, GRCN, ROGUE.hex())
    assert braked == (CMD_VEL,)


def test_who_takes_the_name_of_the_guard_brakes_a_command_that_leaves_the_launch():
    leaving = replace(base_plan(), grcn=(replace(base_plan().grcn[0], successors=()),))
    (alarm, braked) = found(*GUARDS, publisher(CMD_VEL, GRCN, ROGUE), plan=leaving)[0]
    assert (alarm.kind, braked) == (AlarmKind.IMPOSTOR, (CMD_VEL,))


@pytest.mark.parametrize("block_unapproved", [True, False])
def test_the_guards_and_the_supervisors_names_are_ours_too(block_unapproved):
    plan = base_plan(block_unapproved=block_unapproved)
    for name, braked in ((GUARD_NODE, ()), (BULK_NODE, ()), (SUPERVISOR_NODE, (CMD_VEL,))):
        ((alarm, past),) = found(*CLOSED, publisher("/rosout", name, ROGUE), plan=plan)
        assert (alarm.kind, past) == (AlarmKind.IMPOSTOR, braked)


@pytest.mark.parametrize("name", [GUARD_NODE, BULK_NODE])
def test_who_speaks_past_the_guard_with_a_name_that_speaks_nowhere_stops_the_robot(name):
    ((alarm, braked),) = found(*CLOSED, publisher(OUT, name, ROGUE))
    assert (alarm.kind, alarm.node, braked) == (AlarmKind.IMPOSTOR, name, (CMD_VEL,))
    ((_, braked),) = found(*CLOSED, publisher(FLOW1, name, ROGUE))
    assert braked == ()  # the guard refuses it there
    ((_, braked),) = found(publisher(ACTION_STATUS, name, ROGUE), plan=action_plan())
    assert braked == (NAVIGATE,)


def test_who_speaks_past_the_guard_with_the_name_of_another_stream_stops_both():
    both = replace(base_plan(), grcn=(*base_plan().grcn, *action_plan().grcn))
    ((alarm, braked),) = found(*CLOSED, publisher(OUT, NAVIGATE_GRCN, ROGUE), plan=both)
    assert (alarm.kind, braked) == (AlarmKind.IMPOSTOR, (CMD_VEL, NAVIGATE))


def test_the_supervisors_own_participant_may_speak_named_or_not():
    ours = OURS | {TELEOP}
    for name in ("", SUPERVISOR_NODE):
        seen = ObservedGraph([*CLOSED, publisher(OUT, name, TELEOP)])
        assert (
            foreign_endpoint_alarms(ExpectedGraph(base_plan()), seen, ours, GraphAudit().lives, 0)
            == []
        )


def test_listeners_and_nodes_outside_the_plan_are_no_alarm():
    more = [subscriber(OUT, "/rosbag", ROGUE), subscriber(FLOW1, "/rosbag", ROGUE)]
    twins = [publisher("/rosout", "/rviz", each) for each in (ROGUE, TELEOP)]
    assert found(*CLOSED, *more, *twins) == []


def test_a_topic_full_of_strangers_costs_no_more_than_some_and_hides_no_other():
    crowd = [publisher(FLOW1, f"/rogue{n}", ROGUE) for n in range(300)]
    told = found(*CLOSED, *crowd, publisher(OUT, "/rogue", ROGUE))
    assert len(told) == 17
    assert [braked for _, braked in told].count((CMD_VEL,)) == 1


def test_what_strangers_are_called_stays_on_one_line():
    ((alarm, _),) = found(*CLOSED, publisher(OUT, "/a\nb" + "x" * 5000, ROGUE))
    assert "\n" not in alarm.reason
    assert len(alarm.reason) < 400


class TestDoubles:
    SECOND_NAV = publisher("/rosout", "/nav", ROGUE)

    def test_a_second_one_beside_one_that_runs_is_an_impostor_and_brakes_nothing(self):
        look = GraphAudit()
        look.at(0, *CLOSED)
        ((alarm, braked),) = look.at(1, *CLOSED, self.SECOND_NAV)
        assert (alarm.kind, alarm.node, braked) == (AlarmKind.IMPOSTOR, "/nav", ())
        assert NAV.hex() in alarm.reason
        assert ROGUE.hex() in alarm.reason

    def test_one_that_was_killed_and_started_anew_is_no_impostor(self):
        look = GraphAudit()
        look.at(0, *CLOSED)
        look.machine.end(2000)
        for now in (1, MAX_LEASE, 3 * MAX_LEASE):
            assert look.at(now, *CLOSED, self.SECOND_NAV) == []

    def test_one_elsewhere_has_a_lease_to_leave(self):
        look = GraphAudit(running=RUNNING - {2000})
        look.at(0, *CLOSED)
        assert look.at(5, *CLOSED, self.SECOND_NAV) == []
        assert len(look.at(5 + MAX_LEASE, *CLOSED, self.SECOND_NAV)) == 1

    def test_a_second_successor_is_told_too(self):
        look = GraphAudit()
        look.at(0, *CLOSED)
        ((alarm, _),) = look.at(1, *CLOSED, subscriber(OUT, "/driver", ROGUE))
        assert alarm.node == "/driver"


class TestDrift:
    def drifts(self, *ends, plan=None):
        return [
            alarm.reason
            for alarm in drift_alarms(ExpectedGraph(plan or base_plan()), ObservedGraph(ends), OURS)
        ]

    def test_a_driver_outside_its_cell(self):
        celled = replace(base_plan(), cell=("/driver",))
        assert self.drifts(*CLOSED, plan=celled) == [f"/driver listens to {OUT} outside its cell"]

    def test_missing_remaps(self):
        told = self.drifts(
            *GUARDS, publisher(CMD_VEL, "/nav", NAV), subscriber(CMD_VEL, "/driver", DRIVER)
        )
        assert told == [
            f"/driver listens to {CMD_VEL}, not to {OUT}: its remap is missing",
            f"/nav publishes {CMD_VEL}, not {FLOW1}: its remap is missing",
        ]

    def test_a_type_that_is_not_the_plans(self):
        (told,) = self.drifts(*GUARDS, replace(NAV_PUBLISHES, type="std_msgs/msg/String"))
        assert told.startswith("the guard does not hear /nav: its type is std_msgs/String")

    def test_quality_that_does_not_fit(self):
        offered = replace(GUARDS[0], qos=QoS(reliability=Reliability.BEST_EFFORT))
        (told,) = self.drifts(*GUARDS[1:], offered, subscriber(OUT, "/driver", DRIVER))
        assert "/driver does not hear the guard: reliable is asked for" in told

    def test_strangers_do_not_drift(self):
        other = "std_msgs/msg/String"
        ends = (publisher(FLOW1, "/x", ROGUE, type=other), subscriber(OUT, "/x", ROGUE, type=other))
        assert self.drifts(*CLOSED, *ends) == []


class TestAction:
    def test_a_client_beside_the_guard_is_told_and_braked(self):
        rogue = client_endpoint(f"/rtron{NAVIGATE}/out", SEND_GOAL, "/rogue", ROGUE)
        ((alarm, braked),) = found(rogue, plan=action_plan())
        assert alarm.reason.endswith(f"publishes /rtron{NAVIGATE}/out{SEND_GOAL}, past the guard")
        assert braked == (NAVIGATE,)

    def test_a_client_of_the_public_name_is_the_guards_business(self):
        assert (
            found(client_endpoint(NAVIGATE, SEND_GOAL, "/rogue", ROGUE), plan=action_plan()) == []
        )

    def test_a_second_server_is_told_once_and_braked(self):
        status = publisher(ACTION_STATUS, "/rogue", ROGUE)
        service = server_endpoints(ACTION_OUT, SEND_GOAL, "/rogue", ROGUE)
        for ends in ([status], service, [status, *service]):
            assert set(found(*ends, plan=action_plan())) == {
                (
                    Alarm(
                        kind=AlarmKind.FOREIGN_PUBLISHER,
                        reason=f"/rogue of the participant {ROGUE.hex()} offers to serve "
                        f"{NAVIGATE}, too",
                        topic=ACTION_OUT,
                        peer="/rogue",
                    ),
                    (NAVIGATE,),
                )
            }

    def test_a_second_server_without_a_name_has_a_moment_to_be_named(self):
        look, nameless = GraphAudit(action_plan()), publisher(ACTION_STATUS, "", ROGUE)
        assert look.at(0, nameless) == look.at(NAME_TIMEOUT, nameless) == []
        ((alarm, braked),) = look.at(NAME_TIMEOUT + 1, nameless)
        assert (alarm.kind, braked) == (AlarmKind.UNREGISTERED_PUBLISHER, (NAVIGATE,))

    def test_feedback_of_a_stranger_brakes_nothing(self):
        rogue = publisher(f"{ACTION_OUT}/_action/feedback", "/rogue", ROGUE)
        ((alarm, braked),) = found(rogue, plan=action_plan())
        assert (alarm.peer, braked) == ("/rogue", ())

    def test_the_server_and_one_started_in_its_place_are_no_alarm(self):
        look = GraphAudit(action_plan())
        old, new = (publisher(ACTION_STATUS, "/server", each) for each in (NAV, ROGUE))
        assert look.at(0, old) == []
        look.machine.end(2000)
        assert look.at(1, old, new) == []

    def test_a_second_server_with_the_name_of_the_first_is_braked(self):
        one, two = (publisher(ACTION_STATUS, "/server", each) for each in (NAV, ROGUE))
        ((alarm, braked),) = found(one, two, plan=action_plan())
        assert (alarm.kind, alarm.node, braked) == (AlarmKind.IMPOSTOR, "/server", (NAVIGATE,))
        elsewhere = publisher("/rosout", "/server", ROGUE)
        ((_, braked),) = found(one, elsewhere, plan=action_plan())
        assert braked == ()


class TestCases:
    @pytest.fixture
    def alarms(self):
        return Alarms()

    @pytest.fixture
    def cases(self, alarms):
        intrusions = IntrusionLatch(HandoverState())
        host = SimpleNamespace(alarms=alarms, streams=[], intrusions=intrusions)
        return BrakingAlarms(AlarmResponse(host, MemoryTransport(), OnForeign.STOP, dry_run=False))

    def test_what_is_found_stands_until_it_is_found_no_more(self, cases, alarms):
        one, other = ghost("a"), ghost("b")
        cases.update([BrakingAlarm(one, ()), BrakingAlarm(other, (CMD_VEL,))], 1, frozenset())
        assert told(alarms) == (one, other)
        cases.update([BrakingAlarm(other, (CMD_VEL,))], 2, frozenset())
        assert told(alarms) == (other,)
        cases.update([], 3, frozenset())
        assert told(alarms) == ()
        assert [alarm.kind for alarm in alarms.active] == [AlarmKind.INTRUSION]

    def test_who_turns_out_to_be_planned_has_stopped_nothing(self, cases, alarms):
        gid = frozenset({ROGUE + b"abcd"})
        cases.update([BrakingAlarm(ghost("a"), (CMD_VEL,), gid)], 1, frozenset())
        assert cases.intruders(CMD_VEL) == gid
        cases.update([], 2, gid)
        assert alarms.active == ()

    def test_what_an_inherited_intrusion_has_stopped_no_mistake_releases(self, alarms):
        latch = IntrusionLatch(HandoverState(b'{"intrusions": {"/cmd_vel": "a ghost"}}'))
        (guarded,) = Coordinator(MemoryTransport(), build_streams(base_plan())).streams
        host = SimpleNamespace(alarms=alarms, streams=[guarded], intrusions=latch)
        response = AlarmResponse(host, MemoryTransport(), OnForeign.STOP, dry_run=False)
        response.raise_(ghost("a"), 1, CMD_VEL)
        response.withdraw(ghost("a"))
        assert guarded.brake_reason == "a ghost"


def ghost(reason):
    return Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason=reason)


def told(alarms):
    return tuple(each for each in alarms.active if each.kind is not AlarmKind.INTRUSION)


def test_who_publishes_what_the_plan_lets_it_is_planned_whoever_has_a_name_of_ours_is_not():
    ends = [*CLOSED, publisher(OUT, GRCN, ROGUE), publisher(OUT, "/rogue", ROGUE)]
    planned = planned_publishers(ExpectedGraph(base_plan()), ObservedGraph(ends), OURS)
    assert planned == {NAV_PUBLISHES.gid, *(each.gid for each in GUARDS)}


def test_an_endpoint_that_was_dismissed_is_not_looked_at_and_others_of_its_participant_are():
    rogue, other = (publisher(topic, "/rogue", ROGUE) for topic in (OUT, FLOW1))
    seen = ObservedGraph([*CLOSED, rogue, other])
    assert seen.without({rogue.gid}).endpoints == ObservedGraph([*CLOSED, other]).endpoints


def test_every_alarm_says_where_and_is_told_once():
    rogues = [publisher(topic, "/rogue", ROGUE) for topic in (OUT, FLOW1)]
    found_alarms = [alarm for alarm, _ in chain(found(*CLOSED, *rogues), found(*CLOSED, *rogues))]
    assert len(set(found_alarms)) == 2
    assert all(alarm.topic for alarm in found_alarms)
