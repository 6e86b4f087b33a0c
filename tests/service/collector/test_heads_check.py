"""A guard brings heads of the log: what the log does not contain is told, and nothing else."""

import pytest
from collector_server import hello, receive_message, send_message
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from harness import wait_for
from service_app import SIGNER
from sqlalchemy import select, update
from store_data import make_verdict, store_events
from websockets.exceptions import ConnectionClosed

from rtron.service.collector.close_codes import CloseCode
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.hash_chain import DocumentSigner, Head
from rtron.service.store.audit import record_event
from rtron.service.store.chains import chain_heads
from rtron.service.store.robots import register_robot
from rtron.service.store.tables import AuditRow, ChainLinkRow, EventRow
from rtron.vocabulary import AlarmKind, GuardState
from rtron.wire.common.link_protocol import StateReport

REASON = "the service's log was changed: in robot:one entry 2, or one before it, was another"


@pytest.fixture
def held(world):
    """Heads of the log that the guard of `one` got, signed."""
    database = world.collector.database
    with database.session() as session:
        id = register_robot(session, "one", 1).id
        for action in ("stop", "stop.end", "login"):
            record_event(session, 1, AuditEvent(who="ann", action=action, target="one"))
    store_events(database, id, [make_verdict(1)], robot="one")
    with database.session() as session:
        return SIGNER.sign_heads(1, chain_heads(session))


def rewrite(world, number=2):
    with world.collector.database.session() as session:
        where = ChainLinkRow.number == number
        session.execute(update(ChainLinkRow).where(where).values(hash="b" * 64))


def stored(world, table, *where):
    with world.collector.database.session() as session:
        return session.scalars(select(table).where(*where)).all()


def alarms(world):
    state = world.hub.state("one")
    return [alarm.reason for alarm in state.alarms] if state else []


def checked(world):
    """Wait until the heads are compared."""
    world.collector.threads.heads.submit(int).result(60)


def tell_state(guard):
    send_message(guard, StateReport(state=GuardState(at=1, revision=0)))


def test_heads_that_are_in_the_log_raise_nothing(world, held):
    with world.guard(held_heads=(held, held)) as guard:
        checked(world)
        tell_state(guard)
        wait_for(lambda: world.hub.state("one"))
        assert alarms(world) == []
    assert len(stored(world, EventRow)) == 1


def test_a_head_that_is_not_in_the_log_is_an_alarm_an_event_and_a_line(world, held):
    rewrite(world)
    for _ in range(2):
        with world.guard(held_heads=(held,)) as guard:
            tell_state(guard)
            wait_for(lambda: alarms(world) == [REASON])
            tell_state(guard)
            wait_for(lambda: len(stored(world, EventRow)) == 2)
            assert world.hub.state("one").alarms[0].kind is AlarmKind.AUDIT_LOG
        wait_for(lambda: not world.hub.is_connected("one"))
    (event,) = stored(world, EventRow, EventRow.kind == "alarm")
    assert (event.level, event.reason) == ("error", REASON)
    (line,) = stored(world, AuditRow, AuditRow.action == "heads")
    assert (line.target, line.detail["chain"], line.detail["count"]) == ("one", "robot:one", 2)


def test_a_head_of_another_key_is_compared_too(world, held):
    other = DocumentSigner(Ed25519PrivateKey.generate())
    forged = other.sign_heads(1, {"service": Head(7, "a" * 64)})
    with world.guard(held_heads=(forged,)) as guard:
        tell_state(guard)
        wait_for(lambda: stored(world, EventRow, EventRow.kind == "alarm"))
    (reason,) = [event.reason for event in stored(world, EventRow, EventRow.kind == "alarm")]
    assert "entries 2 to 7 are missing" in reason
    assert "(as a head tells, but it is signed with another key)" in reason


def test_heads_of_other_robots_are_not_asked_for(world, held):
    document = SIGNER.sign_heads(1, {"robot:two": Head(7, "a" * 64)})
    with world.guard(held_heads=(document,)) as guard:
        checked(world)
        tell_state(guard)
        wait_for(lambda: world.hub.state("one"))
        assert alarms(world) == []


@pytest.mark.parametrize(
    "odd", [{}, {"heads": 3}, {"heads": {"service": [1]}}, {"heads": {"service": ["x", 2]}}]
)
def test_odd_heads_harm_nothing(small, odd):
    with small.guard(held_heads=(odd,)) as guard:
        checked(small)
        tell_state(guard)
        wait_for(lambda: small.hub.state("one"))
        assert alarms(small) == []


def test_too_many_heads_end_the_connection(small):
    with small.connect() as socket:
        send_message(socket, hello(held_heads=({},) * 9))
        with pytest.raises(ConnectionClosed):
            receive_message(socket)
        assert socket.protocol.close_code == CloseCode.MALFORMED
