"""The service deletes old events: a chain whose beginning somebody deleted is an alarm, once."""

import pytest
from collector_server import CollectorServer
from harness import wait_for
from sqlalchemy import delete, select
from store_data import age_partitions, make_verdict, new_robot, store_events

from rtron.service.store.chains import events_chain
from rtron.service.store.tables import AuditRow, ChainLinkRow, ChainRow, EventRow

FAULT = "where it begins is not proven: it is no rtron.audit_anchor/1"


@pytest.fixture
def robot(database):
    """Make a robot with events of 1970, whose beginning somebody deletes; return its name."""
    id = new_robot(database, "one")
    store_events(database, id, [make_verdict(n) for n in range(1, 6)], robot="one")
    age_partitions(database)
    with database.session() as session:
        chain = session.scalars(select(ChainRow).where(ChainRow.name == events_chain("one"))).one()
        chain.anchor = {"number": 2, "hash": session.get(ChainLinkRow, (chain.id, 2)).hash}
        session.execute(delete(ChainLinkRow).where(ChainLinkRow.number <= 2))
        session.execute(delete(EventRow).where(EventRow.number <= 2))
    return "one"


def stored(database, table, *where):
    with database.session() as session:
        return session.scalars(select(table).where(*where)).all()


class LiveMessages(list):
    """What consoles and webhooks get."""

    put = list.append
    __hash__ = object.__hash__


def test_a_deleted_beginning_is_an_alarm_an_event_and_a_line(database, robot):
    live = LiveMessages()
    for start in (1, 2):
        server = CollectorServer(database)
        tally = server.tally
        server.hub.add_listener(live, states=False)
        with server.serving():
            wait_for(lambda t=tally: t.stored_events + t.duplicate_events)
        assert (tally.stored_events, tally.pruned_events) == (2 - start, 0)
    (event,) = stored(database, EventRow, EventRow.kind == "alarm")
    reason = f"the service's log was changed: in events:one {FAULT}"
    assert (event.level, event.reason) == ("error", reason)
    (message,) = live
    assert (message["event"]["robot"], message["event"]["reason"]) == (robot, reason)
    (line,) = stored(database, AuditRow, AuditRow.action == "retention")
    assert (line.who, line.target, line.detail["count"]) == ("rtron", robot, 2)
    assert line.outcome == f"refused: {FAULT}"
    assert len(stored(database, EventRow)) == 4


def test_a_chain_in_order_is_no_alarm(database):
    id = new_robot(database, "one")
    store_events(database, id, [make_verdict(1)], robot="one")
    age_partitions(database)
    server = CollectorServer(database)
    with server.serving():
        wait_for(lambda: server.tally.pruned_events == 1)
    assert stored(database, AuditRow) == []
    assert stored(database, EventRow) == []
