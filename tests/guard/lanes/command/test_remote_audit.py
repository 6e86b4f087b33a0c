"""The audit in one process and the brakes in another: what each knows when the other comes back."""

import os
import socket
from contextlib import ExitStack
from itertools import pairwise
from types import SimpleNamespace

import pytest
from plans import grcn, plan_of

from rtron.errors import WireError
from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.audit.common.audit_response import EndpointTrust, ListenToPublisher
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import observations_of
from rtron.guard.lanes.bulk import command_nodes, remote_response
from rtron.guard.lanes.bulk.board_writer import BoardWriter
from rtron.guard.lanes.bulk.command_connection import CommandConnection
from rtron.guard.lanes.bulk.command_nodes import CommandNodes
from rtron.guard.lanes.bulk.remote_response import RemoteResponse
from rtron.guard.lanes.command import remote_audit
from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.lanes.command.remote_audit import RemoteAudit
from rtron.guard.lanes.exchange.audit_exchange import MAX_ALARMS, NodesReport
from rtron.guard.lanes.exchange.message_channel import MAX_MESSAGE_BYTES
from rtron.guard.settings.intrusion_clearing import ClearCommands
from rtron.guard.system.process_port import ProcessPort
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Alarm, AlarmKind, OnForeign, build_streams

TOPIC = "/cmd_vel"
PLAN = plan_of(grcn(TOPIC, ["/nav"], ["/driver"]))
GHOST = Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason="a ghost", node="/driver")
ROGUE = Alarm(kind=AlarmKind.FOREIGN_PUBLISHER, reason="a rogue", node="/driver")
DRIFT = Alarm(kind=AlarmKind.DRIFT, reason="a remap is missing", node="/nav")
LIMIT = 20 * SECOND
COMPLETE = ("active_alarms", ())


class Listener:
    """Hears of a stream what the test says; keeps its requests."""

    def __init__(self):
        self.silences, self.requests = {}, []

    def follow(self, request):
        self.requests.append(request)

    def update(self):
        """Do nothing: the test says what is heard."""

    def silence(self, stream):
        return self.silences.get(stream)


class RecordedConnection(BulkConnection):
    """Keeps the calls of the audit, its rounds by themselves."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.calls, self.rounds = [], []

    def _receive(self, call):
        kept = self.rounds if call[0] == "audit_round" else self.calls
        kept.append(call)
        super()._receive(call)


class Commands:
    """The brakes of a command process, and its end of the connection."""

    def __init__(self, processes, handover=b""):
        self.documents = []
        transport = MemoryTransport()
        state = HandoverState(handover, self.documents.append)
        self.host = Coordinator(transport, build_streams(PLAN), handover=state)
        self.response = AlarmResponse(self.host, transport, OnForeign.STOP, dry_run=False)
        self.listener = self.response.listener = Listener()
        self.host.open()
        board, loop = BoardObservations(PLAN), processes.loop
        self.connection = RecordedConnection(
            loop, processes.port.connecting_side, processes.configuration, board, self.host
        )
        self.calls, self.rounds = self.connection.calls, self.connection.rounds
        self.audit = RemoteAudit(self.connection, self.response, loop)
        self.connection.open()

    @property
    def alarms(self):
        return [each for each in self.host.alarms.active if each.kind is not AlarmKind.INTRUSION]

    @property
    def brake_reason(self):
        """Why the stream is stopped until somebody clears it, "" if it is not."""
        reason = self.host.intrusions.reasons.get(TOPIC, "")
        assert not reason or self.host.streams[0].brake_reason == reason
        return reason

    def clear(self):
        request = {"clear": TOPIC, "reason": "seen to"}
        return ClearCommands(self.host).handle("ann", request)


class Bulk:
    """The audit's end of the connection."""

    def __init__(self, processes):
        loop = processes.loop
        writer = BoardWriter(observations_of(PLAN), loop, SharedBeat.create())
        port = processes.accepting_side()
        self.connection = CommandConnection(loop, port, processes.configuration, writer, Alarms())
        self.response = RemoteResponse(self.connection, loop, stops_streams=True)
        self.response.find_missing = lambda: processes.missing
        self.response.find_unseen = processes.find_unseen
        for part in (writer, self.response, self.connection):
            part.open()

    def find(self, *alarms):
        for alarm in alarms:
            self.response.raise_(alarm, 0, TOPIC)


class Processes:
    """Both ends on one loop, connected by a real socket."""

    def __init__(self, stack):
        self.loop, self.configuration, self.port = EventLoop(), b"this plan", ProcessPort()
        self.missing = ""
        """What the audit says that it has not looked at."""
        self.seen_at, self.asked_since = 0, []
        """When the audit has looked after the stream, and since when it was asked."""
        for each in (self.loop, self.port.connecting_side, self.port.accepting_side):
            stack.callback(each.close)
        self._stack = stack

    def find_unseen(self, since):
        self.asked_since.append(since)
        return {} if self.seen_at > since else {TOPIC: "a gap"}

    def accepting_side(self):
        """Return the bulk process's side, as each one has it from the supervisor."""
        return socket.socket(fileno=os.dup(self.port.accepting_side.fileno()))

    def start_commands(self, handover=b""):
        commands = Commands(self, handover)
        self._stack.callback(commands.connection.close)
        return commands

    def start_bulk(self):
        bulk = Bulk(self)
        self._stack.callback(bulk.connection.close)
        return bulk

    def wait(self, condition):
        end = self.loop.now() + LIMIT
        while not condition():
            assert self.loop.now() < end
            self.loop.step(0.02)

    def run(self, duration_s):
        end = self.loop.now() + int(duration_s * SECOND)
        while self.loop.now() < end:
            self.loop.step(0.02)

    def refusal(self, commands):
        response = commands.clear()
        self.wait(response.done)
        error = response.exception()
        assert error is None or isinstance(error, WireError)
        return "" if error is None else str(error)


@pytest.fixture
def stack():
    with ExitStack() as entered:
        yield entered


@pytest.fixture
def processes(stack, monkeypatch):
    monkeypatch.setattr(remote_response, "CHECK_S", 0.01)
    return Processes(stack)


@pytest.fixture
def pair(processes):
    """Return both processes when the audit has called its findings complete."""
    commands, bulk = processes.start_commands(), processes.start_bulk()
    processes.wait(lambda: COMPLETE in commands.calls)
    return SimpleNamespace(commands=commands, bulk=bulk)


def test_what_the_audit_finds_stops_the_stream_and_the_audit_is_told(processes, pair):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.brake_reason == "a ghost")
    processes.wait(lambda: pair.bulk.response.stopped_streams == {TOPIC})
    assert processes.refusal(pair.commands) == "/cmd_vel stays stopped: a ghost"
    pair.bulk.response.settle(GHOST)
    processes.wait(lambda: not pair.commands.alarms)
    assert pair.commands.brake_reason == "a ghost"
    assert processes.refusal(pair.commands) == ""
    assert pair.commands.brake_reason == ""
    processes.wait(lambda: not pair.bulk.response.stopped_streams)


def test_a_mistake_releases_what_it_has_stopped(processes, pair):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.brake_reason)
    pair.bulk.response.withdraw(GHOST)
    processes.wait(lambda: not pair.commands.brake_reason)
    assert pair.commands.host.alarms.active == ()


def test_only_what_changes_is_sent(processes, pair):
    before = len(pair.commands.calls)
    for _ in range(3):
        pair.bulk.find(GHOST)
    pair.bulk.response.settle(ROGUE)
    pair.bulk.response.settle(GHOST)
    processes.wait(lambda: ("settle_alarm", GHOST) in pair.commands.calls)
    sent = pair.commands.calls[before:]
    assert sent == [("raise_alarm", GHOST, (TOPIC,)), ("settle_alarm", GHOST)]


def test_each_round_of_the_audit_is_told_and_what_it_left_out(processes, pair):
    processes.wait(lambda: pair.commands.rounds[-1:] == [("audit_round", {TOPIC: "a gap"})])
    processes.seen_at = processes.loop.now()
    processes.wait(lambda: ("audit_round", {}) in pair.commands.rounds)
    processes.wait(lambda: pair.commands.rounds[-1] == ("audit_round", {TOPIC: "a gap"}))
    assert pair.commands.rounds.count(("audit_round", {})) == 1
    assert processes.asked_since == sorted(set(processes.asked_since))


def test_the_next_command_process_is_told_all_that_is_there(processes, pair):
    pair.bulk.find(GHOST, ROGUE)
    pair.bulk.response.raise_(DRIFT, 0)
    requests = [ListenToPublisher(TOPIC, "/out", "http://a:1"), EndpointTrust(frozenset({b"us"}))]
    for request in requests:
        pair.bulk.response.listen(request)
    processes.wait(lambda: pair.commands.listener.requests == requests)
    processes.wait(lambda: len(pair.commands.alarms) == 3)
    pair.commands.connection.close()
    following = processes.start_commands(pair.commands.documents[-1])
    assert following.brake_reason == "a ghost"
    processes.wait(lambda: set(following.alarms) == {GHOST, ROGUE, DRIFT})
    processes.wait(lambda: following.listener.requests == requests)
    processes.wait(lambda: following.calls[-1][0] == "active_alarms")
    assert "stays stopped: a " in processes.refusal(following)
    kinds = [each.kind for each in following.host.alarms.active]
    assert kinds.count(AlarmKind.INTRUSION) == 1


def test_an_audit_that_lives_on_looks_again_for_the_next_command_process(processes, pair):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    processes.missing = "the command process has not told its nodes"
    pair.commands.connection.close()
    following = processes.start_commands(pair.commands.documents[-1])
    processes.wait(lambda: following.alarms == [GHOST])
    pair.bulk.response.settle(GHOST)
    processes.wait(lambda: not following.alarms)
    processes.run(0.1)
    assert processes.missing in processes.refusal(following)
    assert COMPLETE not in following.calls
    processes.missing = ""
    processes.wait(lambda: COMPLETE in following.calls)
    assert processes.refusal(following) == ""


def test_an_audit_that_has_told_nothing_yet_has_just_begun(processes, pair, monkeypatch):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    pair.bulk.response.settle(GHOST)
    pair.bulk.connection.close()
    processes.wait(lambda: not pair.commands.connection.is_connected)
    monkeypatch.setattr(remote_response, "CHECK_S", 60.0)
    processes.start_bulk()
    processes.wait(lambda: pair.commands.connection.is_connected)
    assert "the audit has just begun" in processes.refusal(pair.commands)


def test_whom_to_listen_to_is_forgotten_with_the_stop(processes, pair):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.bulk.response.stopped_streams)
    pair.bulk.response.listen(ListenToPublisher(TOPIC, "/out", "http://a:1"))
    pair.bulk.response.withdraw(GHOST)
    processes.wait(lambda: not pair.bulk.response.stopped_streams)
    pair.commands.connection.close()
    following = processes.start_commands()
    pair.bulk.response.raise_(DRIFT, 0)
    processes.wait(lambda: following.alarms)
    assert following.listener.requests == []


def test_a_bulk_process_that_begins_again_makes_no_intruder_go_away(processes, pair):
    pair.bulk.find(GHOST, ROGUE)
    processes.wait(lambda: len(pair.commands.alarms) == 2)
    processes.missing = "/driver does not answer"
    pair.bulk.connection.close()
    processes.wait(lambda: not pair.commands.connection.is_connected)
    assert remote_audit.NOT_CONNECTED in processes.refusal(pair.commands)
    assert set(pair.commands.alarms) == {GHOST, ROGUE}
    following = processes.start_bulk()
    processes.wait(lambda: pair.commands.connection.is_connected)
    processes.wait(lambda: "/driver does not answer" in processes.refusal(pair.commands))
    following.find(ROGUE)
    processes.wait(lambda: pair.commands.calls[-1] == ("raise_alarm", ROGUE, (TOPIC,)))
    processes.run(0.1)
    assert set(pair.commands.alarms) == {GHOST, ROGUE}
    assert pair.commands.calls.count(("audit_progress", processes.missing)) == 1
    processes.missing = ""
    processes.wait(lambda: pair.commands.alarms == [ROGUE])
    assert "a rogue" in processes.refusal(pair.commands)
    following.response.settle(ROGUE)
    assert processes.refusal(pair.commands) == ""
    assert pair.commands.host.alarms.raised == 2 + 1  # two intruders, one stop


def test_the_audit_takes_back_what_it_dismisses_before_it_answers(processes, pair):
    def dismiss(topic, is_audible):
        assert (topic, is_audible) == (TOPIC, True)
        pair.bulk.response.settle(GHOST)
        return ""

    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    pair.commands.listener.silences[TOPIC] = 2 * SECOND
    pair.bulk.response.dismiss = dismiss
    assert processes.refusal(pair.commands) == ""
    assert pair.commands.brake_reason == ""


def test_an_intruder_that_is_heard_is_not_asked_for(processes, pair):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    pair.bulk.response.settle(GHOST)
    pair.commands.listener.silences[TOPIC] = SECOND - 1
    response = pair.commands.clear()
    assert response.done()
    assert "within the last second" in str(response.exception())


def test_what_the_audit_refuses_is_told(processes, pair):
    pair.bulk.response.dismiss = lambda topic, is_audible: f"{topic}: heard: {is_audible}"
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    assert processes.refusal(pair.commands).endswith("/cmd_vel: heard: False")


def test_an_audit_that_does_not_answer_in_time_clears_nothing(processes, pair, monkeypatch):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    pair.bulk.response.settle(GHOST)
    processes.wait(lambda: not pair.commands.alarms)
    monkeypatch.setattr(remote_audit, "ANSWER_LIMIT_S", 0.0)
    assert "has not answered" in processes.refusal(pair.commands)
    processes.wait(lambda: pair.commands.calls[-1][0] == "dismiss_answer")
    assert pair.commands.brake_reason == "a ghost"


def test_a_bulk_process_that_ends_answers_nobody(processes, pair):
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    pair.bulk.response.dismiss = lambda topic, is_audible: pair.bulk.connection.close() or ""
    assert remote_audit.NOT_CONNECTED in processes.refusal(pair.commands)
    assert pair.commands.brake_reason == "a ghost"


def test_who_was_dismissed_and_speaks_is_told_to_the_audit(processes, pair):
    returned = []
    pair.bulk.response.on_return = returned.append
    pair.commands.response.on_return(b"gid")
    processes.wait(lambda: returned == [b"gid"])


def test_the_nodes_of_a_command_process_are_known_when_it_has_told_them(
    processes, pair, monkeypatch
):
    nodes = CommandNodes(pair.bulk.connection, processes.loop, frozenset({TOPIC}))
    changes = []
    nodes.on_change = lambda: changes.append(nodes.unknown_streams())
    assert nodes.unknown_streams() == {TOPIC}
    report = NodesReport(
        uris={"/rtron_guard": "http://a:1"}, participant=b"p", former_participants=frozenset({b"q"})
    )
    pair.commands.connection.call("nodes", report)
    processes.wait(lambda: changes == [frozenset()])
    assert nodes.participants() == {b"p", b"q"}
    assert nodes.former_uris == frozenset()
    pair.commands.connection.close()
    processes.wait(lambda: nodes.unknown_streams() == {TOPIC})
    assert nodes.participants() == {b"p", b"q"}, "dead ones are in the graph for a while"
    assert nodes.former_uris == {"http://a:1"}
    assert nodes.report == NodesReport()
    monkeypatch.setattr(command_nodes, "MAX_LEASE", 0)
    assert nodes.participants() == frozenset()


def test_the_participant_of_a_bulk_process_counts_when_it_has_ended(processes, pair):
    assert pair.commands.connection.former_participants() == frozenset()
    pair.bulk.connection.call("participant", b"b")
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.alarms)
    pair.bulk.connection.close()
    processes.wait(lambda: pair.commands.connection.former_participants() == {b"b"})


def test_a_connection_that_does_not_last_is_not_made_again_at_once(processes):
    commands, bulk = processes.start_commands(), processes.start_bulk()
    times = []
    commands.connection.connect_listeners.append(lambda: times.append(processes.loop.now()))
    bulk.connection.connect_listeners.append(lambda: bulk.connection._channel.close())  # noqa: PLW0108 - each has another channel
    processes.wait(lambda: len(times) == 4)
    assert all(later - earlier > SECOND // 20 for earlier, later in pairwise(times))


def test_a_report_that_is_too_long_does_not_end_the_audit(processes, pair):
    pair.commands.connection.call("nodes", NodesReport(uris={"/a": "x" * MAX_MESSAGE_BYTES}))
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.brake_reason == "a ghost")
    assert pair.commands.connection.is_connected


def drift(number):
    return Alarm(kind=AlarmKind.DRIFT, reason=f"{number} ".ljust(190, "x"), node=f"/node_{number}")


def test_many_alarms_do_not_keep_one_from_stopping_the_stream(processes, pair, caplog):
    losses = []
    pair.commands.connection.loss_listeners.append(lambda: losses.append("lost"))
    for number in range(12_000):
        pair.bulk.response.raise_(drift(number), 0)
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.brake_reason == "a ghost")
    assert losses == []
    told = [each for each in pair.commands.calls if each[0] == "raise_alarm"]
    assert len(told) == MAX_ALARMS + 1
    lost = [each for each in caplog.messages if "are not reported" in each]
    assert lost
    assert len(lost) < 10


def test_the_next_command_process_is_told_first_what_stops_a_stream(processes, pair):
    for number in range(12_000):
        pair.bulk.response.raise_(drift(number), 0)
    pair.bulk.find(GHOST)
    processes.wait(lambda: pair.commands.brake_reason)
    pair.commands.connection.close()
    following = processes.start_commands()

    def told():
        return [each for each in following.calls if each[0] == "raise_alarm"]

    processes.wait(lambda: len(told()) == MAX_ALARMS + 1)
    assert told()[0] == ("raise_alarm", GHOST, (TOPIC,))
    assert following.brake_reason


def test_audits_that_begin_again_and_again_fill_no_memory(processes, pair):
    for number in range(2 * MAX_ALARMS):
        pair.bulk.connection.call("raise_alarm", drift(number), ())
    pair.bulk.connection.call("raise_alarm", GHOST, (TOPIC,))
    processes.wait(lambda: pair.commands.brake_reason)
    assert len(pair.commands.audit._alarms) == MAX_ALARMS + 1


def test_a_stream_is_not_cleared_while_an_intruder_waits_to_be_reported(processes, pair):
    ghosts = [
        Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason=f"ghost {number}")
        for number in range(MAX_ALARMS + 1)
    ]
    pair.bulk.find(*ghosts)
    for ghost in ghosts[:-1]:
        pair.bulk.response.settle(ghost)
    processes.wait(lambda: pair.commands.calls[-1] == ("settle_alarm", ghosts[-2]))
    assert "ghost 256" in processes.refusal(pair.commands)
    pair.bulk.response.settle(ghosts[-1])
    assert processes.refusal(pair.commands) == ""


def test_a_bulk_process_with_another_plan_serves_nobody(processes):
    processes.configuration = b"another plan"
    commands = processes.start_commands()
    processes.configuration = b"this plan"
    bulk = processes.start_bulk()
    processes.run(0.3)
    assert not commands.connection.is_connected
    assert not bulk.connection.is_connected
    following = processes.start_commands()
    processes.wait(lambda: following.connection.is_connected)
