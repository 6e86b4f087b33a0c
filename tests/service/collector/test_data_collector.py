import asyncio
import time
from contextlib import suppress
from dataclasses import replace
from threading import Event, Thread

import pytest
from collector_server import (
    LIMIT_S,
    CollectorServer,
    hello,
    receive_message,
    send_events,
    send_message,
)
from failing_database import read_only
from harness import wait_for
from pydantic import TypeAdapter
from sqlalchemy import text
from sqlalchemy.exc import OperationalError
from websockets.exceptions import ConnectionClosed, InvalidStatus

from rtron.errors import InputError, SourceError
from rtron.service.collector.close_codes import CloseCode
from rtron.service.collector.state_throttle import MAX_STATE_BYTES
from rtron.service.controller.risk_controller import RiskController
from rtron.service.domain.clock import SteadyClock
from rtron.service.domain.principal import Principal, UserRole
from rtron.service.live.hub import Hub
from rtron.service.store.database import Database
from rtron.service.store.event_pages import EventFilter, event_page
from rtron.vocabulary import (
    EventKind,
    GuardEvent,
    GuardEventLevel,
    GuardState,
    Mode,
    Settings,
    StreamState,
)
from rtron.wire.common.link_protocol import (
    MAX_EVENTS,
    MAX_MESSAGE_BYTES,
    Applied,
    Events,
    EventsRefused,
    StateDelta,
    StateReport,
    Stored,
    encode_from_guard,
)
from rtron.wire.common.state_deltas import state_delta


def event(number=1, **values):
    return GuardEvent(
        **{"run": "run", "number": number, "at": number, "kind": EventKind.OWNER} | values
    )


def events(first, last):
    return [event(number) for number in range(first, last + 1)]


def stored(world, **conditions):
    with world.collector.database.session() as session:
        page = event_page(session, EventFilter(**conditions), 1000)
    return [each.at for each in reversed(page.events)]


def closed(socket):
    """Return how the service closes a connection."""
    try:
        while True:
            socket.recv(timeout=LIMIT_S)
    except ConnectionClosed as error:
        return error.rcvd.code if error.rcvd else None


@pytest.mark.parametrize("token", ["", "wrong", "secret-one\tx", "secret-on"])
def test_without_a_token_nobody_comes_in(small, token):
    with pytest.raises(InvalidStatus) as raised, small.connect(token):
        pass
    assert raised.value.response.status_code == 401
    assert small.tally.unauthorised_connections == 1
    assert small.controller.hellos == []


def test_what_is_told_as_stored_is_stored(world):
    with world.guard() as socket:
        for first in range(1, 50, 10):
            assert send_events(socket, events(first, first + 9)) == ("run", first + 9)
            assert stored(world) == list(range(1, first + 10))
    assert (world.tally.stored_events, world.tally.duplicate_events) == (50, 0)


def test_what_comes_again_is_told_again_and_stored_once(world):
    with world.guard() as socket:
        send_events(socket, events(1, 10))
    with world.guard() as socket:
        assert send_events(socket, events(1, 10)) == ("run", 10)
        assert send_events(socket, events(5, 15)) == ("run", 15)
    assert stored(world) == list(range(1, 16))
    assert (world.tally.stored_events, world.tally.duplicate_events) == (15, 16)


def test_runs_in_one_message_are_told_apart(small):
    with small.guard() as socket:
        send_message(
            socket, Events(events=(event(7, run="old"), event(8, run="old"), event(1, run="new")))
        )
        assert {receive_message(socket), receive_message(socket)} == {
            Stored(run="old", number=8),
            Stored(run="new", number=1),
        }


def test_guards_at_once(world):
    with world.guard() as one, world.guard("secret-two") as two:
        for socket in (one, two):
            for first in range(1, 1000, 100):
                send_message(socket, Events(events=tuple(events(first, first + 99))))
        for socket in (one, two):
            while receive_message(socket).number < 1000:
                pass
    for robot in ("one", "two"):
        assert stored(world, robot=robot) == list(range(1, 1001))


def test_the_largest_message_is_taken(small):
    with small.guard() as socket:
        assert send_events(socket, events(1, MAX_EVENTS)) == ("run", MAX_EVENTS)


def test_settings_are_given_and_answered(small):
    small.controller.settings = Settings(revision=7)
    with small.connect() as socket:
        send_message(socket, hello(dry_run=True))
        assert receive_message(socket).settings == Settings(revision=7)
        assert small.hub.is_dry_run("one")
        send_message(socket, Applied(revision=7, error="no"))
        wait_for(lambda: small.controller.answers)
    assert small.controller.answers == [("one", Applied(revision=7, error="no"))]
    assert small.controller.hellos[0][0] == "one"


def test_pushed_settings_come_newest_last(small):
    with small.guard() as socket:
        for revision in (3, 2, 1, 4):
            small.hub.push("one", Settings(revision=revision))
        small.hub.push("two", Settings(revision=9))
        heard = [receive_message(socket).settings.revision]
        while heard[-1] < 4:
            heard.append(receive_message(socket).settings.revision)
    assert heard in ([3, 4], [4])


def test_what_is_pushed_during_the_greeting_is_not_lost(small):
    small.controller.on_greet = lambda: _change(small)
    with small.connect() as socket:
        send_message(socket, hello())
        assert receive_message(socket).settings.revision == 2
    assert len(small.controller.hellos) == 2


def _change(world):
    if world.controller.settings.revision == 1:
        world.controller.settings = Settings(revision=2)
        world.hub.push("one", world.controller.settings)


def test_a_guard_says_hello_once(small):
    with small.guard() as socket:
        send_message(socket, hello(run="second"))
        assert closed(socket) == CloseCode.TOO_MUCH
    assert len(small.controller.hellos) == 1


def test_of_many_states_the_newest_are_told(small):
    told = []
    small.hub.set_state = lambda robot, link, state: told.append(state.at)
    with small.guard() as socket:
        for at in range(1, 51):
            send_message(socket, StateReport(state=GuardState(at=at, revision=1)))
        wait_for(lambda: told and told[-1] == 50)
        assert told[0] == 1
        assert len(told) < 25


def test_a_flood_of_states_ends_the_connection(small):
    with small.guard() as socket:
        with suppress(ConnectionClosed):
            for at in range(1, 1000):
                send_message(socket, StateReport(state=GuardState(at=at, revision=1)))
        assert closed(socket) == CloseCode.TOO_MUCH


@pytest.mark.parametrize("more", [0, 1])
def test_a_state_is_bounded(small, more):
    state = encode_from_guard(StateReport(state=GuardState(at=5, revision=3)))
    with small.guard() as socket:
        socket.send(state + b" " * (MAX_STATE_BYTES - len(state) + more), text=True)
        if more:
            assert closed(socket) == CloseCode.TOO_BIG
        else:
            wait_for(lambda: small.hub.state("one"))


def test_a_guard_gets_its_settings_though_nothing_can_be_written(tmp_path):
    """A stop that could not be stored reaches also a guard that connects again."""
    database, hub = Database(tmp_path / "rtron.db"), Hub()
    controller = RiskController(
        database, hub, time.time_ns, SteadyClock(time.time_ns, time.monotonic_ns)
    )
    world = CollectorServer(database)
    world.hub, world.controller = hub, controller
    world.collector = replace(world.collector, hub=hub, handshake=controller)
    developer = Principal(name="mary", roles=frozenset(UserRole))
    with world.serving():
        with world.guard() as socket:
            assert send_events(socket, events(1, 1)) == ("run", 1)
        controller.start_emergency_stop(developer, "one", "so")
        with read_only(database):
            with world.connect() as socket:
                send_message(socket, hello())
                given = receive_message(socket).settings
                assert (given.revision, given.stop.reason) == (1, "so")
                send_message(socket, Applied(revision=1))
                with pytest.raises(SourceError):
                    controller.start_emergency_stop(developer, "one", "again")
                unstored = receive_message(socket).settings
                assert unstored.stop.reason == "again"
            with world.connect() as socket:
                send_message(socket, hello())
                assert receive_message(socket).settings == unstored
                send_message(socket, Events(events=tuple(events(2, 2))))
                assert closed(socket) == CloseCode.FAILED
        with world.guard() as socket:
            assert send_events(socket, events(2, 2)) == ("run", 2)
    database.close()


def test_a_token_that_cannot_be_looked_up_ends_nothing(serve):
    looked = Event()

    def away(_token):
        looked.set()
        raise OperationalError("", None, Exception())

    server = serve(token=0.1)
    with server.guard() as socket:
        object.__setattr__(server.collector.token_watch, "_find_valid", away)
        assert looked.wait(LIMIT_S)
        assert send_events(socket, events(1, 1)) == ("run", 1)


def test_the_state_is_live_until_the_guard_goes(small):
    with small.guard() as socket:
        assert small.hub.is_connected("one")
        assert small.hub.state("one") is None
        send_message(socket, StateReport(state=GuardState(at=5, revision=3)))
        wait_for(lambda: small.hub.state("one"))
        assert small.hub.state("one").revision == 3
    wait_for(lambda: not small.hub.is_connected("one"))
    assert small.hub.state("one") is None


def test_a_second_connection_replaces_the_first(small):
    with small.guard() as first, small.guard() as second:
        assert closed(first) == CloseCode.REPLACED
        assert small.hub.is_connected("one")
        assert send_events(second, events(1, 1)) == ("run", 1)
        small.hub.push("one", Settings(revision=5))
        assert receive_message(second).settings.revision == 5
    assert small.tally.replaced_connections == 1


MALFORMED = [
    b"",
    b"{}",
    b"null",
    b"[" * 5000,
    b'{"type":"hello"}',
    b'{"type":"settings","settings":{},"now":1}',
    b'{"type":"events","events":{}}',
    b'{"type":"events","events":[{"run":"r","number":1,"at":1,"kind":"none"}]}',
    encode_from_guard(Events(events=(event(0),))),
    encode_from_guard(Events(events=(event(1 << 63),))),
    encode_from_guard(Events(events=(event(1, run=""),))),
    b'{"type":"state","state":{"at":"now"}}',
    b"\xff\xfe",
]


@pytest.mark.parametrize("frame", MALFORMED)
def test_what_is_no_message_ends_the_connection(small, frame):
    with small.guard("secret-two") as other, small.guard() as socket:
        socket.send(frame)
        assert closed(socket) == CloseCode.MALFORMED
        assert send_events(other, events(1, 3)) == ("run", 3)
    wait_for(lambda: not small.hub.is_connected("one"))
    assert small.tally.protocol_violations == 1


def test_a_guard_says_hello_first(small):
    for message in (
        Events(events=(event(),)),
        StateReport(state=GuardState(at=1, revision=1)),
        Applied(revision=1),
    ):
        with small.connect() as socket:
            send_message(socket, message)
            assert closed(socket) == CloseCode.MALFORMED
    assert stored(small) == []


@pytest.mark.parametrize("size", [MAX_MESSAGE_BYTES + 2, 4 * MAX_MESSAGE_BYTES])
def test_too_long_a_message_ends_the_connection(small, size):
    with small.guard() as socket:
        with suppress(ConnectionClosed):
            socket.send(b" " * size)
        assert closed(socket) in (None, CloseCode.TOO_BIG)
    with small.guard() as socket:
        assert send_events(socket, events(1, 1)) == ("run", 1)


def test_too_many_events_end_the_connection(small):
    with small.guard() as socket:
        send_message(socket, Events(events=tuple(events(1, MAX_EVENTS + 1))))
        assert closed(socket) == CloseCode.TOO_BIG
    assert stored(small) == []


@pytest.mark.parametrize(
    ("values", "code"),
    [({"protocol": 2}, CloseCode.PROTOCOL), ({"robot": "two"}, CloseCode.WRONG_ROBOT)],
)
def test_a_hello_that_does_not_fit(small, values, code):
    with small.guard() as proper, small.connect() as socket:
        send_message(socket, hello(**values))
        assert closed(socket) == code
        assert send_events(proper, events(1, 1)) == ("run", 1)


def test_a_guard_that_the_controller_refuses(small):
    small.controller.refuse = InputError("this plan is not ours " + "ü" * 200)
    with small.connect() as socket:
        send_message(socket, hello())
        assert closed(socket) == CloseCode.REFUSED
    wait_for(lambda: not small.hub.is_connected("one"))


def test_a_failure_of_the_controller_ends_that_connection_only(small, caplog):
    small.controller.refuse = RuntimeError("broken")
    with small.connect() as socket:
        send_message(socket, hello())
        assert closed(socket) == CloseCode.FAILED
    small.controller.refuse = None
    with small.guard() as socket:
        assert send_events(socket, events(1, 1)) == ("run", 1)


def test_a_state_goes_on_with_what_differs(small):
    with small.guard() as socket:
        before = GuardState(at=5, revision=3, streams=(_stream("/a", ""), _stream("/b", "")))
        after = replace(before, at=6, streams=(_stream("/a", ""), _stream("/b", "flow1")))
        send_message(socket, StateReport(state=before))
        send_message(socket, state_delta(before, after))
        wait_for(lambda: small.hub.state("one") == after)


@pytest.mark.parametrize("is_first", [True, False])
def test_a_delta_that_does_not_fit_ends_the_connection(small, is_first):
    with small.guard() as socket:
        if not is_first:
            send_message(socket, StateReport(state=GuardState(at=5, revision=3)))
        streams = (_stream("/unknown", ""),)
        send_message(socket, StateDelta(state=GuardState(at=6, revision=3, streams=streams)))
        assert closed(socket) == CloseCode.MALFORMED


def test_deltas_cannot_swell_a_state(small):
    topics = [f"/{number}" for number in range(20)]
    with small.guard() as socket:
        before = GuardState(at=5, revision=3, streams=tuple(_stream(topic, "") for topic in topics))
        send_message(socket, StateReport(state=before))
        for topic in topics:
            streams = (_stream(topic, "x" * (MAX_STATE_BYTES // 4)),)
            message = StateDelta(state=GuardState(at=6, revision=3, streams=streams))
            with suppress(ConnectionClosed):
                send_message(socket, message)
        assert closed(socket) == CloseCode.TOO_BIG


def _stream(topic, owner):
    return StreamState(topic=topic, nodes=(), mode=Mode.ENFORCE, owner=owner)


def test_who_says_no_hello_is_dropped(serve):
    server = serve(hello=0.2)
    with server.connect() as socket:
        assert closed(socket) == CloseCode.TOO_SLOW
    wait_for(lambda: server.tally.slow_connections == 1, what="the count")


def test_who_says_nothing_after_the_hello_is_dropped(serve):
    server = serve(silence=0.2)
    with server.guard() as socket:
        assert closed(socket) == CloseCode.TOO_SLOW
    wait_for(lambda: not server.hub.is_connected("one"), what="the end of the connection")
    wait_for(lambda: server.tally.slow_connections == 1, what="the count")


def test_a_token_that_is_revoked_ends_its_connection(serve):
    server = serve(token=0.1)
    with server.guard() as socket:
        del server.tokens["secret-one"]
        assert closed(socket) == CloseCode.NO_TOKEN


def test_who_does_not_read_is_dropped(tmp_path):
    database = Database(tmp_path / "rtron.db")
    with (
        CollectorServer(database, sending=0.3).serving() as world,
        world.connect(max_queue=1, close_timeout=0.1) as socket,
    ):
        send_message(socket, hello())
        wait_for(lambda: world.hub.is_connected("one"))
        revision = 1
        reason = {"by": "x", "reason": "y" * 1_000_000, "at": 1}
        while world.hub.is_connected("one"):
            revision += 1
            stop = {"revision": revision, "stop": reason}
            world.hub.push("one", _settings(stop))
            assert revision < 3_000
            time.sleep(0.01)  # without it this loop takes the processor from who sends
        wait_for(lambda: world.tally.slow_connections == 1)
    database.close()


def _settings(values):
    return TypeAdapter(Settings).validate_python(values)


def test_what_is_not_committed_is_not_acknowledged(world):
    with world.guard() as socket:
        with world.collector.database.session() as session:
            session.execute(text("ALTER TABLE events RENAME TO gone"))
        send_message(socket, Events(events=tuple(events(1, 5))))
        assert closed(socket) == CloseCode.FAILED
        with world.collector.database.session() as session:
            session.execute(text("ALTER TABLE gone RENAME TO events"))
    with world.guard() as socket:
        assert send_events(socket, events(1, 5)) == ("run", 5)
    assert stored(world) == [1, 2, 3, 4, 5]


def test_a_guard_that_takes_refusals_stays_connected(world):
    with world.guard(takes_refusals=True) as socket:
        with world.collector.database.session() as session:
            session.execute(text("ALTER TABLE events RENAME TO gone"))
        send_message(socket, Events(events=tuple(events(1, 5))))
        assert receive_message(socket) == EventsRefused()
        with world.collector.database.session() as session:
            session.execute(text("ALTER TABLE gone RENAME TO events"))
        send_message(socket, Events(events=tuple(events(6, 9))))
        world.hub.push("one", Settings(revision=7))
        assert receive_message(socket).settings.revision == 7
        assert send_events(socket, events(1, 9)) == ("run", 9)
    assert stored(world) == list(range(1, 10))


def test_what_was_lost_is_counted_over_restarts(tmp_path):
    database = Database(tmp_path / "rtron.db")
    lost = event(1, kind=EventKind.LOST, values={"events": 12})
    with CollectorServer(database).serving() as world, world.guard() as socket:
        send_events(socket, [lost])
        send_events(socket, [lost, event(2, kind=EventKind.LOST, values={"events": 3})])
        assert world.hub.lost_event_count("one") == 15
    with CollectorServer(database).serving() as world:
        assert world.hub.lost_event_count("one") == 15
        with world.guard():
            assert world.hub.lost_event_count("one") == 15
    database.close()


def test_who_listens_hears_what_is_live(small):
    heard, ready = [], Event()

    async def listen():
        with small.hub.listen() as listener:
            ready.set()
            async for live in listener:
                heard.append(live)
                if live["type"] == "connection" and not live["connected"]:
                    return

    thread = Thread(target=lambda: asyncio.run(listen()))
    thread.start()
    assert ready.wait(LIMIT_S)
    with small.guard() as socket:
        send_events(socket, [event(1, reason="once")])
        send_events(socket, [event(1, reason="once")])
        send_message(socket, StateReport(state=GuardState(at=5, revision=3)))
        wait_for(lambda: small.hub.state("one"))
    thread.join(LIMIT_S)
    assert [live["type"] for live in heard] == ["connection", "event", "state", "connection"]
    assert heard[1]["event"]["reason"] == "once"
    assert heard[2]["state"].revision == 3


def test_of_very_many_the_gravest_are_told(small):
    told = []
    small.hub.broadcast = told.append
    small.hub._listeners.add(object())
    with small.guard() as socket:
        levels = {5: GuardEventLevel.ERROR, 7: GuardEventLevel.WARNING}
        send_events(
            socket, [event(n, level=levels.get(n, GuardEventLevel.INFO)) for n in range(1, 1001)]
        )
    small.hub._listeners.clear()
    numbers = [live["event"]["at"] for live in told if live["type"] == "event"]
    assert len(numbers) == 200
    assert numbers == [5, 7, *range(803, 1001)]
