"""The link process between a guard and a service, both of which come and go."""

import json
import shutil
import socket
import time

import pytest
from harness import wait_for
from link_parts import TOKEN, Guard, Service, event, options, running_relay, serving

from rtron.errors import SourceError
from rtron.guard.link import service_connection
from rtron.guard.link.event_recorder import EventCounter, former_runs
from rtron.guard.link.link_client import MAX_PENDING_EVENTS
from rtron.guard.link.settings_file import read_settings, write_settings
from rtron.guard.system.machine_time import MachineTime, machine_time
from rtron.vocabulary import (
    SECOND,
    EmergencyStop,
    EventKind,
    NodeSettings,
    PolicyName,
    Settings,
    TimedOverride,
)
from rtron.wire.common.link_protocol import (
    Applied,
    CommandResponse,
    Events,
    EventsRefused,
    Hello,
    LeaseCommand,
    NewSettings,
    StateDelta,
    StateReport,
    Stored,
    encode_to_guard,
)

SETTINGS = Settings(revision=4, nodes={"grcn": NodeSettings(policy=PolicyName.BLOCK)})


@pytest.fixture
def service():
    with serving(Service()) as service:
        yield service


@pytest.fixture
def made(tmp_path, service):
    made = options(tmp_path, service.url)
    yield made
    shutil.rmtree(made.counter_folder, ignore_errors=True)


@pytest.fixture
def guard(made):
    guard = Guard(made)
    yield guard
    guard.close()


def numbers(service, run="run"):
    return [each.number for each in service.events() if each.run == run]


def kept(service, run):
    """Return the numbers as a service keeps them that stores each event once."""
    return list(dict.fromkeys(numbers(service, run)))


def test_events_reach_the_service_once_and_in_order(made, service, guard):
    with running_relay(made) as relay:
        for number in range(1, 3001):
            guard.line.queue_event(event(number))
        guard.until(lambda: len(service.events()) >= 3000, "the events")
        guard.until(lambda: relay._spool.waiting == 0, "the service's word")
    assert numbers(service) == list(range(1, 3001))
    assert service.headers == [f"Bearer {TOKEN}"]
    assert [each.robot for each in service.of(Hello)] == ["r1"]
    assert service.of(StateReport)


LEASE_COMMAND = LeaseCommand(number=5, lease="base", do="end", by="ann", grant=1, reason="lunch")


def test_a_command_for_a_lease_reaches_the_guard_and_its_response_the_service(made, service, guard):
    response = CommandResponse(number=5, granted=True, reason="done")
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the hello")
        assert service.of(Hello)[0].takes_lease_commands
        service.say(LEASE_COMMAND)
        guard.until(lambda: guard.settings == [LEASE_COMMAND], "the command")
        guard.line.send(response)
        guard.until(lambda: service.of(CommandResponse) == [response], "the response")


def test_a_command_for_a_lease_does_not_wait_for_the_next_guard(made, service, guard):
    with running_relay(made) as relay:
        guard.until(lambda: service.of(Hello), "the hello")
        guard.line.close()
        wait_for(lambda: relay._guard_writer is None, what="the end of the guard's connection")
        service.say(LEASE_COMMAND)
        service.say(NewSettings(settings=SETTINGS, now=1))
        wait_for(lambda: read_settings(made.settings_file, machine_time()), what="the settings")
        again = Guard(made, "again")
        again.until(lambda: again.settings, "the settings")
        assert [type(each) for each in again.settings] == [NewSettings]
        again.close()


def test_events_wait_for_a_service_that_is_away(made, guard):
    away = Service(port=0)
    with serving(away):
        pass
    made = options(made.state.parent, away.url)
    with running_relay(made) as relay:
        for number in range(1, 11):
            guard.line.queue_event(event(number))
        guard.until(lambda: relay._spool.waiting == 10, "the events on disk")
        with serving(away):
            guard.until(lambda: numbers(away) == list(range(1, 11)), "the events")


def test_what_was_not_confirmed_is_sent_again(made, service, guard):
    service.confirms = False
    with running_relay(made):
        guard.line.queue_event(event(1))
        guard.until(lambda: numbers(service) == [1], "the event")
        service.confirms = True
        service.socket.close()
        guard.until(lambda: numbers(service) == [1, 1], "the event again")


def test_events_wait_for_a_link_process_that_is_away(made, service, guard):
    for number in range(1, 6):
        guard.line.queue_event(event(number))
    with running_relay(made):
        guard.until(lambda: numbers(service) == [1, 2, 3, 4, 5], "the events")
    for number in range(6, 9):
        guard.line.queue_event(event(number))
    with running_relay(made):
        guard.until(lambda: numbers(service) == list(range(1, 9)), "the later events")


def test_a_guard_keeps_no_more_than_it_may(made, guard):
    assert guard.line.has_capacity
    for number in range(1, MAX_PENDING_EVENTS + 1):
        guard.line.queue_event(event(number))
    assert not guard.line.has_capacity


def test_settings_reach_the_guard_and_the_disk(made, service, guard):
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        service.say(NewSettings(settings=SETTINGS, now=time.time_ns()))
        guard.until(lambda: guard.settings, "the settings")
        assert guard.settings[0].settings == SETTINGS
        assert read_settings(made.settings_file, machine_time()) == SETTINGS
        guard.line.send(Applied(revision=4))
        guard.until(lambda: service.of(Applied), "the answer")
    assert service.of(Applied) == [Applied(revision=4)]


def test_a_guard_that_returns_is_given_the_last_settings(made, service, guard):
    write_settings(made.settings_file, SETTINGS, machine_time())
    with running_relay(made):
        guard.until(lambda: guard.settings, "the settings")
        assert guard.settings[0].settings == SETTINGS
        guard.until(lambda: service.of(Hello), "the greeting")
        guard.line.close()
        newest = Guard(made, "next", revision=4)
        newest.until(lambda: len(service.of(Hello)) == 2, "the next guard's greeting")
        assert newest.settings == []
        newest.close()
    assert [each.run for each in service.of(Hello)] == ["run", "next"]


def test_refused_settings_are_not_kept(made, service, guard):
    write_settings(made.settings_file, Settings(revision=3), machine_time())
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        service.say(NewSettings(settings=SETTINGS, now=time.time_ns()))
        guard.until(lambda: len(guard.settings) == 2, "the settings")
        guard.line.send(Applied(revision=4, error="no such flow"))
        guard.until(lambda: service.of(Applied), "the answer")
    assert read_settings(made.settings_file, machine_time()) == Settings(revision=3)


def test_a_stop_outlives_the_refusal_of_what_came_with_it(made, service, guard):
    write_settings(made.settings_file, Settings(revision=3), machine_time())
    stop = EmergencyStop(by="ada", reason="smoke", at=3)
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        settings = Settings(revision=4, nodes=SETTINGS.nodes, stop=stop)
        service.say(NewSettings(settings=settings, now=time.time_ns()))
        guard.until(lambda: len(guard.settings) == 2, "the settings")
        guard.line.send(Applied(revision=4, error="no such flow"))
        guard.until(lambda: service.of(Applied), "the answer")
    assert read_settings(made.settings_file, machine_time()) == Settings(revision=3, stop=stop)


def test_a_full_disk_keeps_no_stop_from_the_robot(made, service, guard, monkeypatch, caplog):
    def full(path, settings, now):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("rtron.guard.link.relay.write_settings", full)
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        service.say(NewSettings(settings=SETTINGS, now=time.time_ns()))
        guard.until(lambda: guard.settings, "the settings")
        guard.line.send(Applied(revision=4))
        guard.until(lambda: service.of(Applied), "the answer")
    assert "do not outlive" in caplog.text


def test_events_that_are_long_together_go_in_several_messages(made, service, guard):
    text = "x" * 100_000
    service.confirms = False
    for number in range(1, 101):
        guard.line.queue_event(event(number, kind=EventKind.COUNTS, values={"text": text}))
    with running_relay(made):
        guard.until(lambda: kept(service, "run") == list(range(1, 101)), "the events")
        service.heard.clear()
        service.confirms = True
        service.socket.close_socket()
        guard.until(lambda: kept(service, "run") == list(range(1, 101)), "the events again")
    assert max(len(message.events) for message in service.of(Events)) < 20


def test_a_token_that_is_away_for_a_moment_ends_nothing(made, service, guard):
    token = made.token_file.read_text()
    made.token_file.unlink()
    with running_relay(made) as relay:
        guard.until(lambda: relay._service._last_warning, "the failure")
        assert "token create" not in relay._service._last_warning
        made.token_file.write_text(token)
        guard.until(lambda: service.of(Hello), "the greeting")


def test_the_first_settings_refused_leave_none(made, service, guard):
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        service.say(NewSettings(settings=SETTINGS, now=time.time_ns()))
        guard.until(lambda: guard.settings, "the settings")
        guard.line.send(Applied(revision=4, error="no such flow"))
        guard.until(lambda: service.of(Applied), "the answer")
    assert read_settings(made.settings_file, machine_time()) is None


def test_an_override_ends_by_the_machines_time_whatever_wall_clocks_say(
    made, service, guard, monkeypatch
):
    override = TimedOverride(by="ada", reason="docking", until=60 * SECOND)
    settings = Settings(revision=5, overrides={"rsrcn": override})
    wall = time.time_ns
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        before = machine_time().now
        service.say(NewSettings(settings=settings, now=0))
        guard.until(lambda: guard.settings, "the settings")
        after = machine_time().now
        until = guard.settings[0].settings.overrides["rsrcn"].until
        assert before <= until - 60 * SECOND <= after
        monkeypatch.setattr(time, "time_ns", lambda: wall() - 7200 * SECOND)
        again = Guard(made)
        guard.close()
        again.until(lambda: again.settings, "the settings again")
        again.close()
    assert again.settings[0].settings.overrides["rsrcn"].until == until
    assert again.settings[0].now <= machine_time().now
    assert read_settings(made.settings_file, machine_time()) == again.settings[0].settings


def test_what_a_killed_guard_took_with_it_is_told(made, service, guard):
    counter = EventCounter(made.counter_folder, "killed")
    for _ in range(7):
        counter.next()
    killed = Guard(made, "killed")
    with running_relay(made):
        for number in range(1, 5):
            killed.line.queue_event(event(number, "killed"))
        killed.until(lambda: numbers(service, "killed") == [1, 2, 3, 4], "the events")
        killed.close()
        returned = Guard(made, "next")
        returned.until(lambda: service.events()[-1].kind is EventKind.LOST, "the loss")
        returned.close()
    lost = service.events()[-1]
    assert lost.values == {"events": 3, "run": "killed"}
    assert not made.counter_folder.exists()


@pytest.mark.parametrize(("takes_deltas", "kind"), [(True, StateDelta), (False, StateReport)])
def test_a_service_gets_what_differs_only_if_it_takes_that(
    made, service, guard, takes_deltas, kind
):
    with running_relay(made):
        guard.until(lambda: service.of(StateReport), "the state")
        service.say(NewSettings(settings=SETTINGS, now=0, takes_state_deltas=takes_deltas))
        guard.until(lambda: guard.settings, "the settings")
        known = len(service.of(kind))
        guard.line.send(guard.state())
        guard.until(lambda: len(service.of(kind)) > known, "the next state")
    assert bool(service.of(StateDelta)) == takes_deltas


def test_the_service_sees_that_the_guard_is_gone(made, service, guard):
    with running_relay(made):
        guard.until(lambda: service.of(StateReport), "the state")
        guard.close()
        wait_for(lambda: service.socket.close_code is not None, what="the end of the connection")


def test_garbage_from_the_service_ends_the_connection_only(made, service, guard):
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the first greeting")
        for text in ("{", "[]", json.dumps({"type": "settings"}), "x" * 10_000, "[" * 5000):
            heard = len(service.of(Hello))
            service.socket.send(text)
            guard.until(lambda n=heard: len(service.of(Hello)) > n, "the next greeting")
    assert guard.settings == []


def test_garbage_from_a_guard_ends_its_connection_only(made, service, guard):
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        with socket.socket(socket.AF_UNIX) as stranger:
            stranger.settimeout(10)
            stranger.connect(made.address)
            stranger.sendall(b"nonsense\n")
            assert stranger.recv(1) == b""
        guard.until(lambda: guard.line._sock, "the guard's return")
        guard.line.queue_event(event(1))
        guard.until(lambda: numbers(service) == [1], "the event")


def test_two_guards_do_not_share_a_state(made, service, guard, caplog):
    with running_relay(made):
        guard.until(lambda: service.of(Hello), "the greeting")
        other = Guard(made, "other")
        other.until(lambda: "give each its own --state-dir" in caplog.text, "the refusal")
        guard.line.close()
        other.line.queue_event(event(1, "other"))
        other.until(lambda: numbers(service, "other") == [1], "the event of the other one")
        other.close()
    assert [each.run for each in service.of(Hello)] == ["run", "other"]


def test_what_a_killed_guard_said_last_is_read_before_the_next_one_speaks(made, service):
    killed = Guard(made, "killed")
    with running_relay(made):
        killed.until(lambda: service.of(Hello), "the greeting")
        counter = EventCounter(made.counter_folder, "killed")
        for _ in range(200):
            killed.line.queue_event(event(counter.next(), "killed"))
        killed.line._send_batch()
        counter.next()
        killed.close()
        returned = Guard(made, "next")
        returned.until(lambda: len(service.of(Hello)) == 2, "the next greeting")
        returned.line.queue_event(event(1, "next"))
        returned.until(lambda: numbers(service, "next") == [1], "the next event")
        returned.close()
    assert kept(service, "killed") == list(range(1, 201))
    lost = [each for each in service.events() if each.kind is EventKind.LOST]
    assert lost[0].values == {"events": 1, "run": "killed"}


def test_two_link_processes_do_not_share_a_state(made):
    with running_relay(made) as relay:
        wait_for(lambda: listens(made), what="the first link process")
        with pytest.raises(SourceError, match="another link process"):
            relay._bind()


def listens(made):
    with socket.socket(socket.AF_UNIX) as sock:
        return sock.connect_ex(made.address) == 0


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b'{"type":"stored","run":"r","number":1}'])
def test_settings_that_cannot_be_read_are_an_error(tmp_path, text):
    path = tmp_path / "settings.json"
    assert read_settings(path, machine_time()) is None
    path.write_bytes(text)
    with pytest.raises(SourceError, match="a stop may be among them"):
        read_settings(path, machine_time())


def test_settings_are_kept_whole(tmp_path):
    path = tmp_path / "settings.json"
    stop = EmergencyStop(by="ada", reason="smoke", at=3)
    write_settings(path, Settings(revision=9, stop=stop), MachineTime(7, "boot"))
    assert read_settings(path, MachineTime(7, "boot")) == Settings(revision=9, stop=stop)
    assert read_settings(path, MachineTime(1, "other")) == Settings(revision=9, stop=stop)
    message = NewSettings(settings=Settings(revision=9, stop=stop), now=7, boot="boot")
    assert path.read_bytes() == encode_to_guard(message)
    assert [each.name for each in tmp_path.iterdir()] == ["settings.json"]


@pytest.mark.parametrize(
    "later", [MachineTime(100, "other"), MachineTime(6, "boot"), MachineTime(8, "")]
)
def test_no_override_goes_on_where_nobody_knows_what_is_left_of_it(tmp_path, later):
    path = tmp_path / "settings.json"
    override = TimedOverride(by="ada", reason="docking", until=9)
    settings = Settings(revision=5, overrides={"rsrcn": override})
    write_settings(path, settings, MachineTime(7, "boot"))
    assert read_settings(path, MachineTime(8, "boot")) == settings
    assert read_settings(path, later) == Settings(revision=5)


def test_a_run_that_cannot_be_kept_is_counted_all_the_same(tmp_path, caplog):
    counter = EventCounter(tmp_path / "none", "run")
    assert [counter.next(), counter.next()] == [1, 2]
    assert "will not be counted" in caplog.text
    assert list(former_runs(tmp_path / "none", "run")) == []


def test_events_that_the_service_refuses_come_again_on_the_same_connection(tmp_path, monkeypatch):
    monkeypatch.setattr(service_connection, "_REFUSED_PAUSE_S", 0.05)
    with serving(Service(confirms=False)) as service:
        made = options(tmp_path, service.url)
        guard = Guard(made)
        with running_relay(made):
            for number in range(1, 6):
                guard.line.queue_event(event(number))
            guard.until(lambda: len(service.events()) >= 5, "the events")
            assert service.of(Hello)[0].takes_refusals
            service.say(Stored(run="run", number=2))
            service.say(EventsRefused())
            guard.until(lambda: len(service.events()) >= 8, "the events again")
            guard.line.queue_event(event(6))
            guard.until(lambda: len(service.events()) >= 9, "the next event")
            assert [each.number for each in service.events()] == [1, 2, 3, 4, 5, 3, 4, 5, 6]
            assert len(service.of(Hello)) == 1
        guard.close()
