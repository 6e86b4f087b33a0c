"""A guarded action in memory: two clients, a stranger and a server, spoken to in whole messages."""

import struct

import pytest
from plans import grcn, plan_of
from streams import stage, stream

from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.message_types import standard_info
from rtron.guard.replay.player import RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.ros1.actions import (
    ABORTED,
    ACTIVE,
    PENDING,
    PREEMPTED,
    RECALLED,
    REJECTED,
    SUCCEEDED,
    GoalID,
    GoalStatus,
    cancel_message,
    read_cancel,
    read_goal,
    read_result,
    read_statuses,
    result_message,
    with_statuses,
)
from rtron.policies.goals.registry import ID_REUSE_DELAY, MAX_GOALS
from rtron.policies.goals.status_list import LOST_TIMEOUT
from rtron.vocabulary import SECOND, Flow, OnSilence, PolicyName, StreamKind

GOAL_TYPE, RESULT_TYPE = "demo_msgs/GoActionGoal", "demo_msgs/GoActionResult"
RULE = "=" * 80
HEADER = f"\n{RULE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id"
ID = f"\n{RULE}\nMSG: actionlib_msgs/GoalID\ntime stamp\nstring id"
STATUS = (
    f"\n{RULE}\nMSG: actionlib_msgs/GoalStatus\n"
    "actionlib_msgs/GoalID goal_id\nuint8 status\nstring text"
)
FLOWS = (
    Flow(name="flow1", publisher="/one", priority=1),
    Flow(name="flow2", publisher="/two", priority=2),
    Flow(name="flow3", publisher="/rogue", priority=3, block=True),
)
ONE, TWO, SERVER = "/one", "/two", "/server"


def info(type, text):
    return TypeInfo(type, parse_definition(type, text).md5sum, text)


GOAL = info(
    GOAL_TYPE,
    "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\ndemo_msgs/GoGoal goal"
    + HEADER
    + ID
    + f"\n{RULE}\nMSG: demo_msgs/GoGoal\nint32 x",
)
RESULT = info(
    RESULT_TYPE,
    "std_msgs/Header header\nactionlib_msgs/GoalStatus status\ndemo_msgs/GoResult result"
    + HEADER
    + STATUS
    + ID
    + f"\n{RULE}\nMSG: demo_msgs/GoResult\nint32 y\nstring why",
)
CANCEL = standard_info("actionlib_msgs/GoalID", Encoding.ROS1)
STATUSES = standard_info("actionlib_msgs/GoalStatusArray", Encoding.ROS1)


def framed(body):
    return struct.pack("<I", len(body)) + body


def goal_message(id, stamp=0, x=0):
    goal_id = struct.pack("<II", *divmod(stamp, SECOND)) + struct.pack("<I", len(id)) + id
    return framed(bytes(16) + goal_id + struct.pack("<i", x))


def status_message(*statuses):
    return with_statuses(framed(bytes(16 + 4)), statuses)


def cancel_of(id=b"", stamp=0):
    return framed(struct.pack("<II", *divmod(stamp, SECOND)) + struct.pack("<I", len(id)) + id)


class Act:
    """The guard of /act; who speaks is named, and what it says arrives at once."""

    def __init__(self, policy=PolicyName.FIFO_QUEUE, *streams, will=None, flows=FLOWS, **more):
        settings = {key: more.pop(key) for key in ("max_age", "max_hold") if key in more}
        settings.setdefault("max_age", 60 * SECOND)
        made = stage("grcn_act", policy, flows, StreamKind.ACTION, **settings)
        self.stream = stream(
            made, topic="/act/goal", type=GOAL_TYPE, flows=flows, successors=(SERVER,), **more
        )
        self.transport = MemoryTransport()
        dry_run = False
        self.host = Coordinator(
            self.transport, [self.stream, *streams], dry_run=dry_run, handover=will
        )
        self.host.open()
        self.action = self.host.streams[0]
        self.to_server = self.transport.listen("/rtron/act/goal/out")
        self.cancels = self.transport.listen("/rtron/act/cancel/out")
        self.results = self.transport.listen("/rtron/act/result/out")
        self.statuses = self.transport.listen("/rtron/act/status/out")
        self._says = {}

    def say(self, topic, node, type, message, **more):
        key = (topic, node)
        if key not in self._says:
            self._says[key] = self.transport.publisher(topic, Peer(node, type, **more))
        self._says[key](message)
        self.transport.advance(0)

    def serve(self, *statuses):
        """Let the server be there, with these goals."""
        self.say("/rtron/act/result/server", SERVER, RESULT, framed(b"")) if not self.serving else 0
        self.say("/rtron/act/status/server", SERVER, STATUSES, status_message(*statuses))

    def serving_again(self):
        """Let the next status come over another connection."""
        self._says.pop(("/rtron/act/status/server", SERVER))

    @property
    def serving(self):
        return self.action.server.empty_result is not None

    def ask(self, node, id, stamp=0, **more):
        flow = next((f.name for f in self.stream.flows if f.publisher == node), None)
        topic = f"/rtron/act/goal/{flow}" if flow else "/act/goal"
        self.say(topic, node, GOAL, goal_message(id, stamp), **more)

    def cancel(self, node, id=b"", stamp=0):
        flow = next((f.name for f in self.stream.flows if f.publisher == node), None)
        topic = f"/rtron/act/cancel/{flow}" if flow else "/act/cancel"
        self.say(topic, node, CANCEL, cancel_of(id, stamp))

    def finish(self, id, status=SUCCEEDED):
        message = result_message(0, GoalStatus(GoalID(id, 0), status), bytes(8))
        self.say("/rtron/act/result/server", SERVER, RESULT, message)

    def started(self):
        return [read_goal(message).id for message in self.to_server]

    def answers(self):
        found = map(read_result, self.results)
        return [(status.goal.id, status.status) for status in found]

    def told(self):
        self.transport.advance(SECOND // 50)
        return read_statuses(self.statuses[-1])


def active(*ids):
    return [GoalStatus(GoalID(id, 0), ACTIVE) for id in ids]


@pytest.fixture
def act():
    made = Act()
    made.serve()
    return made


def test_one_goal_at_a_time_and_who_waits_is_pending(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    assert act.started() == [b"a"]
    assert act.told() == {b"a": PENDING, b"b": PENDING}
    act.serve(*active(b"a"))
    assert act.told() == {b"a": ACTIVE, b"b": PENDING}
    act.finish(b"a")
    assert act.started() == [b"a", b"b"]
    assert act.answers() == [(b"a", SUCCEEDED)]


def test_a_terminal_status_lets_the_next_go_and_the_result_is_still_handed_on(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.serve(GoalStatus(GoalID(b"a", 0), SUCCEEDED))
    assert act.started() == [b"a", b"b"]
    act.finish(b"a")
    assert act.started() == [b"a", b"b"]
    assert act.answers() == [(b"a", SUCCEEDED)]


def test_another_goals_end_does_not_end_the_turn(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.finish(b"stranger")
    act.serve(*active(b"a"), GoalStatus(GoalID(b"stranger", 0), SUCCEEDED))
    assert act.started() == [b"a"]


def test_results_come_once(act):
    act.ask(ONE, b"a")
    act.finish(b"a")
    act.finish(b"a", ABORTED)
    assert act.answers() == [(b"a", SUCCEEDED)]


def test_a_blocked_flow_is_rejected_with_the_reason(act):
    act.ask("/rogue", b"a")
    assert act.answers() == [(b"a", REJECTED)]
    assert act.started() == []
    assert act.told() == {b"a": REJECTED}
    assert b"flow3 is blocked" in act.results[0]


def test_a_stranger_is_not_heard_and_not_answered(act):
    act.ask(ONE, b"a")
    act.ask("/stranger", b"b")
    act.cancel("/stranger", b"a")
    act.cancel("/stranger")
    assert act.started() == [b"a"]
    assert (act.cancels, act.answers()) == ([], [])


def test_a_stranger_that_may_speak_touches_only_its_own(act):
    act = Act(block_unapproved=False)
    act.serve()
    act.ask(ONE, b"a")
    act.ask("/stranger", b"b")
    act.ask("/other", b"c")
    act.cancel("/stranger")
    assert act.answers() == [(b"b", RECALLED)]
    assert act.cancels == []


def test_cancels_touch_only_their_own_goals(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.cancel(TWO, b"a")
    act.cancel(TWO)
    assert (act.cancels, act.answers()) == ([], [(b"b", RECALLED)])
    act.cancel(ONE)
    assert [read_cancel(message) for message in act.cancels] == [GoalID(b"a", 0)]


@pytest.mark.parametrize(("stamp", "gone"), [(4, []), (5, [b"b"]), (7, [b"b", b"c"])])
def test_a_cancel_with_a_stamp_means_what_came_before(act, stamp, gone):
    act.ask(ONE, b"a", stamp=1)
    act.ask(TWO, b"b", stamp=5)
    act.ask(TWO, b"c", stamp=7)
    act.cancel(TWO, stamp=stamp)
    assert [id for id, _ in act.answers()] == gone


def test_a_cancel_may_come_before_its_goal(act):
    act.cancel(TWO, b"a")
    act.cancel(ONE, b"b")
    act.ask(ONE, b"a")
    act.ask(ONE, b"b")
    assert act.started() == [b"a"]
    assert act.answers() == [(b"b", RECALLED)]


def test_a_cancel_is_not_remembered_for_ever(act):
    act.cancel(ONE, b"a")
    act.transport.advance(ID_REUSE_DELAY)
    act.ask(ONE, b"a")
    assert act.started() == [b"a"]


def test_cancelled_goals_leave_their_room_to_others():
    act = Act(queue_size=1)
    act.serve()
    act.ask(ONE, b"a")
    act.ask(ONE, b"b")
    act.ask(ONE, b"c")
    assert act.answers() == [(b"c", REJECTED)]
    act.cancel(ONE, b"b")
    act.ask(ONE, b"d")
    act.ask(TWO, b"e")
    act.finish(b"a")
    assert act.started() == [b"a", b"d"]
    act.serve()
    over = {b"a": SUCCEEDED, b"b": RECALLED, b"c": REJECTED}
    assert act.told() == over | {b"d": PENDING, b"e": PENDING}


def test_the_id_of_anothers_goal_is_not_taken(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"a")
    act.finish(b"a")
    act.ask(TWO, b"a")
    assert act.started() == [b"a"]
    assert act.answers() == [(b"a", SUCCEEDED)]


def test_an_id_may_be_used_again_by_its_client(act):
    for _ in range(2):
        act.ask(ONE, b"a")
        act.finish(b"a")
        act.transport.advance(ID_REUSE_DELAY)
    assert act.started() == [b"a", b"a"]


@pytest.mark.parametrize(("latching", "runs"), [(True, 1), (False, 2)])
def test_a_latched_goal_does_not_run_again_over_a_new_connection(act, latching, runs):
    for _ in range(2):
        say = act.transport.publisher("/rtron/act/goal/flow1", Peer(ONE, GOAL, latching))
        say(goal_message(b"a"))
        act.finish(b"a")
        act.transport.advance(ID_REUSE_DELAY)
    assert act.started() == [b"a"] * runs


def test_an_empty_id_gets_a_name(act):
    act.ask(ONE, b"")
    act.ask(ONE, b"")
    (id,) = act.started()
    assert id.startswith(b"/rtron/grcn_act-1-")
    act.finish(id)
    assert len(set(act.started())) == 2


@pytest.mark.parametrize(("length", "started"), [(1024, 1), (1025, 0)])
def test_a_huge_id_is_dropped(act, length, started):
    act.ask(ONE, b"a" * length)
    assert len(act.started()) == started


@pytest.mark.parametrize(
    "body", [b"", bytes(15), bytes(16 + 8), bytes(16 + 8) + b"\xff\xff\xff\x7f"]
)
def test_what_is_no_goal_is_dropped(act, body):
    act.say("/rtron/act/goal/flow1", ONE, GOAL, framed(body))
    act.say("/rtron/act/cancel/flow1", ONE, CANCEL, framed(body[:5]))
    act.ask(ONE, b"a")
    assert act.started() == [b"a"]


def test_without_a_server_goals_are_rejected():
    act = Act()
    act.ask(ONE, b"a")
    assert (act.started(), act.statuses) == ([], [])


@pytest.mark.parametrize("deaf", [True, False])
def test_clients_see_the_server_once_it_hears_the_guard(deaf):
    act = Act()
    if deaf:
        act.transport.unreachable.add(SERVER)
    act.serve()
    assert (act.statuses == []) == deaf
    act.ask(ONE, b"a")
    assert act.answers() == ([(b"a", REJECTED)] if deaf else [])


def test_goals_are_aborted_when_their_server_is_gone(act):
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    act.transport.advance(LOST_TIMEOUT - 1)
    assert act.answers() == []
    act.transport.advance(1)
    assert act.answers() == [(b"a", ABORTED)]
    act.finish(b"a")
    assert act.answers() == [(b"a", ABORTED)]


def test_goals_are_aborted_when_a_new_server_does_not_know_them(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.serve(*active(b"a"))
    act.transport.advance(LOST_TIMEOUT)
    act.serve()
    assert act.answers() == [(b"a", ABORTED)]
    assert act.started() == [b"a", b"b"]


def test_a_result_that_does_not_come_is_made_good_from_the_status(act):
    act.ask(ONE, b"a")
    over = GoalStatus(GoalID(b"a", 0), SUCCEEDED)
    act.serve(over)
    act.transport.advance(LOST_TIMEOUT - 1)
    act.serve(over)
    assert act.answers() == []
    act.transport.advance(1)
    act.serve(over)
    assert act.answers() == [(b"a", SUCCEEDED)]
    act.finish(b"a")
    assert act.answers() == [(b"a", SUCCEEDED)]


def test_a_goal_that_was_answered_for_a_lost_server_is_cancelled_when_it_is_back(act):
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    act.transport.advance(LOST_TIMEOUT)
    act.transport.publisher("/rtron/act/status/server", Peer(SERVER, STATUSES))
    assert act.answers() == [(b"a", ABORTED)]
    act.serve(*active(b"a"))
    assert [read_cancel(message).id for message in act.cancels] == [b"a"]


def test_a_goal_that_waited_too_long_is_recalled():
    act = Act(max_age=SECOND)
    act.serve()
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.transport.advance(SECOND)
    assert act.answers() == [(b"b", RECALLED)]
    act.finish(b"a")
    assert act.started() == [b"a"]


def test_a_goal_that_a_rule_refuses_when_its_turn_comes_holds_up_nobody():
    act = Act()
    act.serve()
    for node, id in ((ONE, b"a"), (TWO, b"b"), (ONE, b"c")):
        act.ask(node, id)
    act.action.pipeline.policies[0].observe_done(0)
    act.action.pipeline.bar("a rule", ["flow2"], "an area is closed")
    act.finish(b"a")
    act.transport.advance(0)
    assert act.started() == [b"a", b"c"]
    assert (b"b", RECALLED) in act.answers()


def test_goals_wait_for_a_server_that_is_gone(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    act.transport.advance(LOST_TIMEOUT)
    assert (act.answers(), act.started()) == ([(b"a", ABORTED)], [b"a"])
    act.transport.advance(SECOND)
    act.serving_again()
    act.serve()
    assert act.started() == [b"a", b"b"]


def test_goals_go_on_when_a_server_is_back_that_has_one_of_its_own(act):
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.serve(*active(b"a"))
    act.transport.leave("/rtron/act/status/server", Peer(SERVER, STATUSES))
    act.serving_again()
    act.serve(*active(b"s1"))
    assert act.started() == [b"a"]
    act.serve(GoalStatus(GoalID(b"s1", 0), SUCCEEDED))
    assert act.started() == [b"a", b"b"]


def test_goals_reach_the_server_in_the_order_of_their_stamps(act):
    act.ask(ONE, b"a", stamp=5)
    act.ask(TWO, b"b", stamp=3)
    act.ask(ONE, b"c", stamp=7)
    act.finish(b"a")
    act.finish(b"b")
    assert [read_goal(message).stamp for message in act.to_server] == [5, 5, 7]


def test_a_goal_that_is_over_stays_listed_until_its_result_has_surely_come(act):
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    act.finish(b"a")
    act.serve()
    assert act.told() == {b"a": SUCCEEDED}
    act.transport.advance(ID_REUSE_DELAY)
    act.serve()
    assert act.told() == {}


def test_goals_that_are_not_over_are_bounded():
    act = Act(queue_size=2000)
    act.serve()
    for number in range(MAX_GOALS + 1):
        act.ask(ONE, b"%d" % number)
    assert act.answers() == [(b"%d" % MAX_GOALS, REJECTED)]


def test_the_highest_goes_next():
    act = Act(PolicyName.PRIORITY_QUEUE)
    act.serve()
    for id in (b"a", b"b"):
        act.ask(ONE, id)
    act.ask(TWO, b"c")
    act.finish(b"a")
    act.finish(b"c")
    assert act.started() == [b"a", b"c", b"b"]


def test_a_goal_of_the_servers_own_has_the_turn(act):
    act.serve(*active(b"/server-1"))
    act.ask(ONE, b"a")
    assert act.started() == []
    act.serve(GoalStatus(GoalID(b"/server-1", 0), PREEMPTED))
    assert act.started() == [b"a"]


DRIVING = Flow(name="flow1", publisher=SERVER, priority=1, on_silence=OnSilence.RELEASE)


def test_a_block_that_rises_cancels_the_goal_and_stops_what_it_moves():
    velocity = stream(stage(flows=(DRIVING,)), flows=(DRIVING,))
    act = Act(PolicyName.FIFO_QUEUE, velocity)
    act.serve()
    act.ask(ONE, b"a")
    act.serve(*active(b"a"))
    twist = standard_info("geometry_msgs/Twist", Encoding.ROS1)
    driver = act.transport.listen("/rtron/cmd_vel/out")
    go = framed(struct.pack("<6d", 1, 0, 0, 0, 0, 0))
    act.say("/rtron/cmd_vel/flow1", SERVER, twist, go)
    act.action.pipeline.bar("a test", ["flow1"], "an area is closed")
    act.host.recheck()
    assert [read_cancel(message).id for message in act.cancels] == [b"a"]
    act.say("/rtron/cmd_vel/flow1", SERVER, twist, go)
    act.transport.advance(2 * SECOND)
    assert driver.count(go) == 1
    assert driver[-1] == framed(bytes(48))
    act.finish(b"a", PREEMPTED)
    act.say("/rtron/cmd_vel/flow1", SERVER, twist, go)
    assert driver[-1] == go
    assert len(act.cancels) == 1


def test_the_next_guard_knows_whose_goals_there_are():
    written = []
    act = Act(will=HandoverState(write=written.append))
    act.serve()
    act.ask(ONE, b"a")
    act.ask(TWO, b"b")
    act.transport.advance(SECOND // 100)
    again = Act(will=HandoverState(written[-1]))
    again.serve(*active(b"a"))
    assert again.told() == {b"a": ACTIVE, b"b": PENDING}
    again.ask(ONE, b"c")
    again.cancel(TWO)
    assert (again.started(), again.cancels) == ([], [])
    again.cancel(ONE, b"a")
    assert [read_cancel(message).id for message in again.cancels] == [b"a"]
    again.transport.advance(3 * SECOND)
    assert (b"b", RECALLED) in again.answers()
    again.finish(b"a", PREEMPTED)
    assert again.started() == [b"c"]


def test_a_recording_of_the_app_without_a_guard_is_judged_as_a_whole():
    act = Act()
    goal, cancel, result = (
        RecordedStream(f"/act/{part}", info.type, info.md5sum, info.definition, node)
        for part, info, node in (
            ("goal", GOAL, ONE),
            ("cancel", CANCEL, ONE),
            ("result", RESULT, SERVER),
        )
    )
    rows = [
        (goal, goal_message(b"a")),
        (goal, goal_message(b"b")),
        (goal, goal_message(b"c")),
        (cancel, cancel_of(b"b")),
        (result, result_message(0, GoalStatus(GoalID(b"a", 0), SUCCEEDED), bytes(8))),
    ]
    flows = tuple(act.stream.flows[:1])
    settings = {"type": GOAL_TYPE, "kind": StreamKind.ACTION, "policy": PolicyName.FIFO_QUEUE}
    plan = plan_of(grcn("/act/goal", (), [SERVER], flows=flows, max_age=60 * SECOND, **settings))
    found = RecordingPlayer(plan).play(((n, *row) for n, row in enumerate(rows)), lambda _: None)
    ((count, _),) = (stream.flows for stream in found.streams)
    assert (count.passed, count.held, count.dropped) == (2, 2, 1)


def test_a_goal_that_was_answered_is_not_again_by_the_next_guard():
    written = []
    act = Act(will=HandoverState(write=written.append))
    act.serve()
    act.ask(ONE, b"a")
    act.transport.advance(SECOND)
    act.finish(b"a")
    again = Act(will=HandoverState(written[-1]))
    again.serve()
    again.transport.advance(LOST_TIMEOUT)
    again.serve()
    again.finish(b"a")
    assert again.answers() == []


def test_the_next_guard_knows_the_stamp_of_the_last_goal():
    written = []
    act = Act(will=HandoverState(write=written.append))
    act.serve()
    act.ask(ONE, b"a", stamp=9 * SECOND)
    act.finish(b"a")
    again = Act(will=HandoverState(written[-1]))
    again.serve()
    again.ask(ONE, b"b", stamp=5 * SECOND)
    assert read_goal(again.to_server[0]).stamp == 9 * SECOND


def test_a_cancel_message_means_one_goal():
    assert read_cancel(cancel_message(b"x")) == GoalID(b"x", 0)


# Goals without an id

SIMPLE = "/act_simple/goal"
POSE = TypeInfo("geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5")


def simple_stream(**more):
    queue = stage(
        "grcn_simple", PolicyName.FIFO_QUEUE, FLOWS, StreamKind.ACTION, max_age=60 * SECOND
    )
    settings = {"topic": SIMPLE, "type": POSE.type, "successors": (SERVER,), "done": "/act/result"}
    return stream(queue, flows=FLOWS, **settings | more)


class Simple(Act):
    """A guarded action whose server takes goals on /act_simple/goal, too."""

    def __init__(self):
        super().__init__(PolicyName.FIFO_QUEUE, simple_stream())
        self.simple = self.transport.listen("/rtron/act_simple/goal/out")
        self.serve()

    def give(self, node, goal):
        flow = next(f.name for f in FLOWS if f.publisher == node)
        self.say(f"/rtron/act_simple/goal/{flow}", node, POSE, goal)


def test_a_goal_without_an_id_is_done_when_the_goal_is_that_appeared_next():
    act = Simple()
    act.give(ONE, b"first")
    act.give(TWO, b"second")
    act.serve(*active(b"s1"))
    act.finish(b"another")
    assert act.simple == [b"first"]
    act.finish(b"s1")
    assert act.simple == [b"first", b"second"]
    act.serve(GoalStatus(GoalID(b"s1", 0), SUCCEEDED), *active(b"s2"))
    assert act.simple == [b"first", b"second"]


def test_an_action_waits_while_a_goal_without_an_id_is_in_progress():
    act = Simple()
    act.give(ONE, b"first")
    act.serve(*active(b"s1"))
    act.ask(ONE, b"a")
    assert act.started() == []
    act.finish(b"s1")
    assert act.started() == [b"a"]


def test_a_goal_without_an_id_waits_for_an_action():
    act = Simple()
    act.ask(ONE, b"a")
    act.give(ONE, b"first")
    assert act.simple == []
    act.finish(b"a")
    assert act.simple == [b"first"]


def test_a_client_s_goal_that_is_refused_is_not_the_pose_s():
    act = Simple()
    act.give(ONE, b"first")
    act.give(TWO, b"second")
    act.ask("/rogue", b"a")
    assert act.simple == [b"first"]
    act.serve(*active(b"s1"))
    act.finish(b"s1")
    assert act.simple == [b"first", b"second"]


def test_a_pose_that_becomes_no_goal_holds_up_nobody():
    act = Simple()
    act.give(ONE, b"first")
    act.give(TWO, b"second")
    act.ask(ONE, b"a")
    act.transport.advance(5 * SECOND - 1)
    assert (act.simple, act.started()) == ([b"first"], [])
    act.transport.advance(1)
    assert (act.simple, act.started()) == ([b"first", b"second"], [])
    act.transport.advance(5 * SECOND)
    assert act.started() == [b"a"]


def test_a_followed_goal_that_is_cancelled_gives_its_turn_to_the_next():
    act = Simple()
    act.give(ONE, b"first")
    act.give(TWO, b"second")
    act.serve(*active(b"s1"))
    act.host.streams[1].pipeline.bar("a test", ["flow1"], "an area is closed")
    act.host.recheck()
    act.finish(b"s1", PREEMPTED)
    assert act.simple == [b"first", b"second"]


def test_a_block_cancels_the_goal_that_was_followed():
    act = Simple()
    act.give(ONE, b"first")
    act.serve(*active(b"s1"))
    act.host.streams[1].pipeline.bar("a test", ["flow1"], "an area is closed")
    act.host.recheck()
    act.host.recheck()
    assert [read_cancel(message).id for message in act.cancels] == [b"s1"]


def test_without_a_guarded_action_the_public_topics_tell():
    transport = MemoryTransport()
    host = Coordinator(transport, [simple_stream()])
    host.open()
    out, cancels = transport.listen("/rtron/act_simple/goal/out"), transport.listen("/act/cancel")
    give = transport.publisher("/rtron/act_simple/goal/flow1", Peer(ONE, POSE))
    tell = transport.publisher("/act/status", Peer(SERVER, STATUSES))
    end = transport.publisher("/act/result", Peer(SERVER, RESULT))
    tell(status_message(*active(b"old")))
    give(b"first")
    give(b"second")
    tell(status_message(*active(b"old", b"s1")))
    end(result_message(0, GoalStatus(GoalID(b"old", 0), SUCCEEDED), b""))
    tell(framed(bytes(3)))
    assert out == [b"first"]
    tell(status_message(GoalStatus(GoalID(b"s1", 0), SUCCEEDED)))
    assert out == [b"first", b"second"]
    end(result_message(0, GoalStatus(GoalID(b"quick", 0), SUCCEEDED), b""))
    give(b"third")
    assert out == [b"first", b"second", b"third"]
    tell(status_message(*active(b"s3")))
    host.streams[0].pipeline.bar("a test", ["flow1"], "an area is closed")
    host.recheck()
    assert [read_cancel(message).id for message in cancels] == [b"s3"]
