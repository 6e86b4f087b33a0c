import pytest
from store_data import SECOND, make_event, new_robot, store_events

from rtron.service.store import event_pages
from rtron.service.store.database import Database
from rtron.service.store.event_pages import MAX_PAGE_EVENTS, EventFilter, event_page
from rtron.vocabulary import EventKind, GuardEventLevel


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def filled(request, tmp_path_factory):
    """Give a database of each kind with ten events each of two robots; tests only read it."""
    where = tmp_path_factory.mktemp("filled") / "rtron.db"
    if request.param == "postgresql":
        where = request.getfixturevalue("postgresql").new_database()
    database = Database(where)
    for name in ("one", "two"):
        robot = new_robot(database, name)
        store_events(database, robot, [_event(number) for number in range(1, 11)], robot=name)
    yield database
    database.close()


def _event(number):
    return make_event(
        number,
        kind=EventKind.ALARM if number % 2 else EventKind.OWNER,
        level=(GuardEventLevel.INFO, GuardEventLevel.WARNING, GuardEventLevel.ERROR)[number % 3],
        node=f"node{number % 4}",
        topic=f"/topic{number % 5}",
        reason=f"Reason 100%_{number}",
    )


def page_numbers(database, limit=100, **wanted):
    with database.session() as session:
        page = event_page(session, EventFilter(**wanted), limit)
    return [(each.robot, each.at // SECOND) for each in page.events]


def test_the_newest_come_first(filled):
    assert page_numbers(filled, limit=2) == [("two", 10), ("two", 9)]
    assert page_numbers(filled, limit=2, robot="one") == [("one", 10), ("one", 9)]


@pytest.mark.parametrize("limit", [1, 3, 7, 10, 19, 20, 21])
@pytest.mark.parametrize("wanted", [{}, {"robot": "one"}, {"level": GuardEventLevel.WARNING}])
def test_pages_together_have_each_event_once(filled, limit, wanted):
    everything = page_numbers(filled, **wanted)
    pages, before = [], None
    with filled.session() as session:
        while True:
            page = event_page(session, EventFilter(before=before, **wanted), limit)
            assert len(page.events) <= limit
            pages += [(each.robot, each.at // SECOND) for each in page.events]
            before = page.next
            if before is None:
                break
    assert pages == everything
    assert len(set(pages)) == len(pages)


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        ({"kind": EventKind.ALARM}, [9, 7, 5, 3, 1]),
        ({"counts": False}, [10, 9, 8, 7, 6, 5, 4, 3, 2, 1]),
        ({"level": GuardEventLevel.INFO}, [10, 9, 8, 7, 6, 5, 4, 3, 2, 1]),
        ({"level": GuardEventLevel.WARNING}, [10, 8, 7, 5, 4, 2, 1]),
        ({"level": GuardEventLevel.ERROR}, [8, 5, 2]),
        ({"node": "node1"}, [9, 5, 1]),
        ({"topic": "/topic0"}, [10, 5]),
        ({"text": "reason 100%_1"}, [10, 1]),
        ({"text": "%"}, [10, 9, 8, 7, 6, 5, 4, 3, 2, 1]),
        ({"text": "%%"}, []),
        ({"text": "0__"}, []),
        ({"text": "' OR 1=1 --"}, []),
        ({"since": 8 * SECOND}, [10, 9, 8]),
        ({"until": 3 * SECOND}, [2, 1]),
        ({"since": 3 * SECOND, "until": 5 * SECOND, "kind": EventKind.ALARM}, [3]),
        ({"since": 1 << 70}, []),
        ({"until": -(1 << 70)}, []),
        ({"before": 1 << 70, "after": 8}, [10, 9]),
    ],
)
def test_filters(filled, wanted, expected):
    assert page_numbers(filled, robot="one", **wanted) == [("one", number) for number in expected]


def test_of_a_robot_nobody_knows_there_is_nothing(filled):
    assert page_numbers(filled, robot="three") == []


def test_a_page_has_an_end(database):
    robot = new_robot(database)
    store_events(database, robot, [make_event(number) for number in range(1, MAX_PAGE_EVENTS + 3)])
    assert len(page_numbers(database, limit=MAX_PAGE_EVENTS + 2)) == MAX_PAGE_EVENTS
    assert len(page_numbers(database, limit=0)) == 1


@pytest.mark.parametrize("span", [1, 3, 7, 19, 20, 100])
@pytest.mark.parametrize(
    "wanted", [{"text": "reason"}, {"text": "_7"}, {"text": "nowhere"}, {"since": 5 * SECOND}]
)
def test_a_search_goes_on_behind_what_one_page_looks_through(filled, monkeypatch, span, wanted):
    everything = page_numbers(filled, **wanted)
    monkeypatch.setattr(event_pages, "MAX_SEARCHED_EVENTS", span)
    pieces, before, calls = [], None, 0
    with filled.session() as session:
        while True:
            page = event_page(session, EventFilter(before=before, **wanted))
            pieces += [(each.robot, each.at // SECOND) for each in page.events]
            before, calls = page.next, calls + 1
            if before is None:
                break
    assert pieces == everything
    assert calls == max(1, -(-20 // span))


def test_the_figures_of_each_second_can_be_left_out(database):
    robot = new_robot(database, "one")
    kinds = [EventKind.COUNTS, EventKind.OWNER, EventKind.COUNTS]
    store_events(
        database, robot, [make_event(n, kind=kind) for n, kind in enumerate(kinds, 1)], robot="one"
    )
    assert page_numbers(database) == [("one", 3), ("one", 2), ("one", 1)]
    assert page_numbers(database, counts=False) == [("one", 2)]
