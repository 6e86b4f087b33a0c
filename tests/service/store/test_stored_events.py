import json
import math
from threading import Thread

import pytest
from sqlalchemy import select
from store_data import SECOND, make_event, make_verdict, new_robot, store_events

from rtron.errors import WireError
from rtron.service.store.event_pages import EventFilter, event_page
from rtron.service.store.events import (
    MAX_RUN_LENGTH,
    MAX_VALUES_LENGTH,
    EventBatch,
    add_events,
    check_event,
    lost_event_count,
    lost_events_by_robot,
)
from rtron.service.store.tables import CoordinationNodeRow, EventRow
from rtron.vocabulary import Decision, EventKind, GuardEventLevel

LARGEST = (1 << 63) - 1


def numbers(rows):
    return [row["number"] for row in rows]


def violation(database, node="grcn"):
    with database.session() as session:
        query = select(CoordinationNodeRow).where(CoordinationNodeRow.node == node)
        row = session.scalars(query).one()
        return row.triggered, row.violation


def only(database):
    with database.session() as session:
        return event_page(session, EventFilter()).events[0]


def test_what_is_stored_again_is_not_new(database):
    robot = new_robot(database)
    assert numbers(store_events(database, robot, [make_event(1), make_event(2)])) == [1, 2]
    assert numbers(
        store_events(database, robot, [make_event(1), make_event(2), make_event(3)])
    ) == [3]
    assert (
        numbers(store_events(database, robot, [make_event(1), make_event(2), make_event(3)])) == []
    )
    with database.session() as session:
        assert session.query(EventRow).count() == 3


def test_an_event_twice_in_one_message_is_one(database):
    robot = new_robot(database)
    assert numbers(store_events(database, robot, [make_event(1), make_event(1)])) == [1]


def test_the_first_that_came_stays(database):
    robot = new_robot(database)
    store_events(database, robot, [make_event(1, reason="first")])
    store_events(database, robot, [make_event(1, reason="second")])
    assert only(database).reason == "first"


def test_runs_and_robots_are_apart(database):
    robots = {name: new_robot(database, name) for name in ("one", "two")}
    for name, id in robots.items():
        for run in ("a", "b"):
            assert len(store_events(database, id, [make_event(1, run=run)], robot=name)) == 1


def test_batches_of_many_robots_are_one_transaction(database):
    batches = [
        EventBatch(
            new_robot(database, name), name, [make_event(number) for number in range(1, 1500)]
        )
        for name in ("one", "two", "three")
    ]
    with database.session() as session:
        added = add_events(session, 1, batches)
    assert len(added) == 3 * 1499
    assert {each.robot for each in added} == {"one", "two", "three"}
    ids = [each.row["id"] for each in added]
    assert ids == sorted(set(ids))


def test_writers_at_once_store_each_event_once(database):
    robot = new_robot(database)
    new = []

    def write():
        for first in range(1, 201, 50):
            new.extend(
                store_events(database, robot, [make_event(n) for n in range(first, first + 50)])
            )

    threads = [Thread(target=write) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(numbers(new)) == list(range(1, 201))


def test_no_events(database):
    assert store_events(database, new_robot(database), []) == []


def test_ids_are_never_used_again(database):
    robot = new_robot(database)
    before = store_events(database, robot, [make_event(1)])[0]["id"]
    with database.session() as session:
        session.query(EventRow).delete()
    assert store_events(database, robot, [make_event(2)])[0]["id"] > before


@pytest.mark.parametrize(
    ("what", "counts"),
    [
        (make_verdict(1), True),
        (make_verdict(1, Decision.MODIFY), True),
        (make_verdict(1, Decision.PASS), False),
        (make_verdict(1, Decision.HOLD), False),
        (make_event(1, kind=EventKind.STOP, node="grcn", level=GuardEventLevel.WARNING), True),
        (make_event(1, kind=EventKind.RULE, node="grcn", level=GuardEventLevel.WARNING), True),
        (make_event(1, kind=EventKind.RULE, node="grcn"), False),
        (make_event(1, kind=EventKind.ALARM, node="grcn", level=GuardEventLevel.ERROR), False),
        (make_event(1, kind=EventKind.OWNER, node="grcn", decision=Decision.DROP), False),
    ],
)
def test_a_violation_is_kept_with_its_node(database, what, counts):
    store_events(database, new_robot(database, nodes=["grcn", "other"]), [what])
    triggered, kept = violation(database)
    assert (triggered == SECOND) is counts
    assert (kept is not None and kept["kind"] == what.kind) is counts
    assert violation(database, "other") == (None, None)


def test_the_newest_violation_stays(database):
    robot = new_robot(database, nodes=["grcn"])
    store_events(
        database, robot, [make_verdict(1), make_verdict(5, reason="newest"), make_event(6)]
    )
    store_events(database, robot, [make_verdict(3)])
    triggered, kept = violation(database)
    assert (triggered, kept["reason"], kept["robot"]) == (5 * SECOND, "newest", "robot")


def test_a_violation_that_comes_again_changes_nothing(database):
    robot = new_robot(database, nodes=["grcn"])
    store_events(database, robot, [make_verdict(1)])
    with database.session() as session:
        session.scalars(select(CoordinationNodeRow)).one().triggered = None
    store_events(database, robot, [make_verdict(1)])
    assert violation(database)[0] is None


def test_texts_fit_their_columns(database):
    names = ("node", "topic", "flow", "publisher", "reason")
    store_events(database, new_robot(database), [make_event(1, **dict.fromkeys(names, "ü" * 5000))])
    assert len(only(database).reason) == 1000


def test_nul_is_no_text_for_postgresql(database):
    store_events(
        database, new_robot(database), [make_event(1, reason="a\0b", values={"a\0": "\0"})]
    )
    found = only(database)
    assert (found.reason, found.values) == ("a\ufffdb", {"a\0": "\0"})


def test_numbers_that_json_does_not_have(database):
    values = {"a": [math.nan, {"b": -math.inf}], "c": 1.5, "d": 10**400}
    store_events(database, new_robot(database), [make_event(1, values=values)])
    assert only(database).values == {"a": [None, {"b": None}], "c": 1.5, "d": 10**400}


@pytest.mark.parametrize("extra", [-1, 0, 1])
def test_values_are_bounded(database, extra):
    values = {"a": "x" * (MAX_VALUES_LENGTH - len(json.dumps({"a": ""})) + extra)}
    store_events(database, new_robot(database), [make_event(1, values=values)])
    expected = {"left_out": MAX_VALUES_LENGTH + 1} if extra > 0 else values
    assert only(database).values == expected


@pytest.mark.parametrize(
    "values",
    [
        {"run": ""},
        {"run": "x" * (MAX_RUN_LENGTH + 1)},
        {"run": "a\0"},
        {"number": 0},
        {"number": LARGEST + 1},
        {"at": -1},
        {"at": LARGEST + 1},
        {"revision": -1},
        {"revision": LARGEST + 1},
    ],
)
def test_an_event_without_a_name_is_refused(values):
    with pytest.raises(WireError):
        check_event(make_event(**{"number": 1, **values}))


def test_the_largest_numbers_are_stored(database):
    largest = make_event(LARGEST, run="x" * MAX_RUN_LENGTH, at=LARGEST, revision=LARGEST)
    check_event(largest)
    assert len(store_events(database, new_robot(database), [largest])) == 1


def test_what_was_lost_is_summed_by_robot(database):
    robots = {name: new_robot(database, name) for name in ("one", "two")}
    for number, count in enumerate((3, 4, "many", True, -1), start=1):
        told = make_event(number, kind=EventKind.LOST, values={"events": count})
        store_events(database, robots["one"], [told], robot="one")
    with database.session() as session:
        assert lost_events_by_robot(session) == {"one": 7}
    assert lost_event_count({}) == 0
