import shutil
from contextlib import ExitStack, closing
from functools import cache
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from service_app import SIGNER
from sqlalchemy import delete, select, text, update
from store_data import age_partitions, make_event, make_verdict, new_robot, prune, store_events

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.hash_chain import GENESIS, DocumentSigner, Head, Witness, next_head
from rtron.service.store.audit import record_event, record_repeatable
from rtron.service.store.chain_check import all_chains, chain_links, check_database, snapshot
from rtron.service.store.chains import chain_heads
from rtron.service.store.database import Database
from rtron.service.store.retention import RetentionLimits
from rtron.service.store.tables import AuditRow, ChainLinkRow, ChainRow, EventRow, RobotRow
from rtron.vocabulary import EventKind

DAY = 86_400_000_000_000
KEYS = {SIGNER.public_key}
ALL = RetentionLimits(max_days=1000, max_bytes=1 << 40)
DETAIL = {"reason": "docking \u202e 😀 ä", "duration": 0.1 + 0.2, "big": 1 << 70, "zero": -0.0}


def log(database, who="mary", action="login", target="mary", at=5, **detail):
    with database.session() as session:
        record_event(session, at, AuditEvent(who=who, action=action, target=target, detail=detail))


def check(database, witnesses=None, keys=KEYS):
    with snapshot(database) as session:
        return check_database(session, witnesses or {}, keys)


def faults(database, witnesses=None, keys=KEYS):
    report = check(database, witnesses, keys)
    return [
        *report.faults,
        *(f"{each.chain}: {fault}" for each in report.chains for fault in each.faults),
    ]


def change(database, *statements):
    """Do what an admin of the database can."""
    with database.session() as session:
        for statement in statements:
            session.execute(statement, execution_options={"synchronize_session": False})


def heads(database):
    """Return the heads of all chains as somebody outside has them."""
    with database.session() as session:
        found = chain_heads(session)
    return {name: [Witness(head, "of noon")] for name, head in found.items()}


@pytest.fixture(scope="module")
def original(request, migrated_file, tmp_path_factory):
    """Fill a database once for each kind, and return its place."""

    @cache
    def fill_once(kind, fill):
        if kind == "postgresql":
            place = request.getfixturevalue("postgresql").new_database()
        else:
            place = Path(shutil.copy(migrated_file, tmp_path_factory.mktemp("original")))
        with closing(Database(place)) as database:
            fill(database)
        return place

    return fill_once


@pytest.fixture(params=["sqlite", "postgresql"])
def copied(request, original, tmp_path):
    """Open a copy, in a database of each kind, of what a function fills."""
    with ExitStack() as stack:

        def copy(fill):
            place = original(request.param, fill)
            if request.param == "postgresql":
                place = request.getfixturevalue("postgresql").copy_database(place)
            else:
                place = Path(shutil.copy(place, tmp_path))
            return stack.enter_context(closing(Database(place)))

        yield copy


@pytest.fixture
def filled(copied):
    """Give a database with a log and with events of two robots."""
    return copied(log_and_events)


@pytest.fixture
def aged(copied):
    """Give a database with 2,500 old events and two new ones."""
    return copied(old_and_new)


def log_and_events(database):
    for number in range(6):
        log(database, detail=number)
        log(database, action="stop", target="car1", reason=f"fire {number}")
    for name in ("car1", "car2"):
        robot = new_robot(database, name)
        events = [make_verdict(n, reason=f"too fast {n}", values={"v": n / 3}) for n in range(1, 7)]
        store_events(database, robot, events, robot=name)


def test_what_is_written_is_whole(filled):
    report = check(filled, heads(filled))
    assert report.is_whole
    assert {each.chain: (each.end.number, each.compared) for each in report.chains} == {
        "service": (6, 1),
        "robot:car1": (6, 1),
        "events:car1": (6, 1),
        "events:car2": (6, 1),
    }


def test_odd_texts_and_numbers_come_back_as_they_went_in(database):
    log(database, **DETAIL)
    robot = new_robot(database)
    values = {"b": [1e300, -0.0, 1e-7, {"ä\u202e": None, "a": "\ud83d\ude00"}], "a": 10**30}
    store_events(database, robot, [make_verdict(1, reason="\0 ä \u2028 😀", values=values)])
    assert check(database).is_whole


def test_counts_are_in_no_chain(database):
    robot = new_robot(database)
    store_events(database, robot, [make_event(n, kind=EventKind.COUNTS) for n in (1, 2)])
    store_events(database, robot, [make_verdict(3)])
    assert check(database).is_whole
    with database.session() as session:
        assert chain_heads(session)["events:robot"].number == 1


def test_an_event_that_comes_twice_is_one_entry(database):
    robot = new_robot(database)
    for _ in range(2):
        store_events(database, robot, [make_verdict(1), make_verdict(2)])
    assert check(database).is_whole
    with database.session() as session:
        assert chain_heads(session)["events:robot"].number == 2


def test_what_is_taken_back_is_in_no_chain(database):
    log(database)
    with database.session() as session:
        record_event(session, 5, AuditEvent(who="me", action="login", target=""))
        session.rollback()
    assert check(database).is_whole


def test_how_often_a_line_is_counted_is_no_part_of_it(database):
    event = AuditEvent(who="", action="login", target="an unknown name")
    for _ in range(3):
        with database.session() as session:
            record_repeatable(session, 5, event, "refused: wrong password")
    assert check(database).is_whole
    with database.session() as session:
        assert session.scalar(select(AuditRow)).detail["count"] == 3


# What an admin of the database can do, found without anything from outside.

AUDIT_COLUMNS = {
    "at": 1,
    "who": "john",
    "address": "10.0.0.1",
    "action": "logout",
    "target": "x",
    "outcome": "refused: no",
}


def faults_while_changed(database, row, id, **values):
    """Return what is found while a row has these values; it gets its own again."""
    columns = [getattr(row, name) for name in values]
    with database.session() as session:
        before = session.execute(select(*columns).where(row.id == id)).one()
    change(database, update(row).where(row.id == id).values(values))
    found = faults(database)
    own = dict(zip(values, before, strict=True))
    change(database, update(row).where(row.id == id).values(own))
    return found


def test_each_changed_column_of_a_line_is_found(filled):
    for column, value in AUDIT_COLUMNS.items():
        found = faults_while_changed(filled, AuditRow, 5, **{column: value})
        assert found == ["service: entry 3 was changed, or is not where it was"], column
    assert faults(filled) == []


def test_a_changed_detail_is_found(filled):
    change(filled, update(AuditRow).where(AuditRow.id == 4).values(detail={"reason": "none"}))
    assert faults(filled) == ["robot:car1: entry 2 was changed, or is not where it was"]


EVENT_COLUMNS = {
    "run": "r",
    "number": 99,
    "at": 1,
    "stored": 2,
    "kind": "alarm",
    "level": "error",
    "node": "n",
    "topic": "t",
    "flow": "f",
    "publisher": "p",
    "policy": "p",
    "decision": "pass",
    "reason": "",
    "revision": 7,
    "values": {"v": 0},
    "robot_id": 2,
}


def test_each_changed_column_of_an_event_is_found(filled):
    for column, value in EVENT_COLUMNS.items():
        found = faults_while_changed(filled, EventRow, 3, **{column: value, "number": 99})
        assert found == ["events:car1: entry 3 was changed, or is not where it was"], column
    assert faults(filled) == []


def test_an_event_that_is_made_a_statistic_is_found(filled):
    change(
        filled,
        delete(ChainLinkRow).where(
            ChainLinkRow.entry_id == 3,
            ChainLinkRow.number == 3,
            ChainLinkRow.chain_id == _chain_id(filled, "events:car1"),
        ),
        update(EventRow).where(EventRow.id == 3).values(kind="counts"),
    )
    assert faults(filled) == ["events:car1: entry 3 is missing"]


def _chain_id(database, name):
    with database.session() as session:
        return session.scalar(select(ChainRow.id).where(ChainRow.name == name))


def test_a_deleted_line_or_event_is_found(filled):
    change(
        filled, delete(AuditRow).where(AuditRow.id == 5), delete(EventRow).where(EventRow.id == 2)
    )
    assert set(faults(filled)) == {
        "service: entry 3 is gone, only its hash is left",
        "events:car1: entry 2 is gone, only its hash is left",
    }


def test_two_lines_that_change_places_are_found(filled):
    with filled.session() as session:
        first, second = session.get(AuditRow, 1), session.get(AuditRow, 3)
        first.detail, second.detail = second.detail, first.detail
    assert faults(filled) == [
        f"service: entry {n} was changed, or is not where it was" for n in (1, 2)
    ]


def copy_of_the_first_event(id):
    return text(
        f"INSERT INTO events SELECT * FROM (SELECT {id} AS id, robot_id, run, 77 AS number, at, "
        "stored, kind, level, node, topic, flow, publisher, policy, decision, reason, "
        'revision, "values" FROM events WHERE id = 1) AS copied'
    )


def test_a_line_or_event_that_is_put_in_is_found(filled):
    with filled.session() as session:
        session.add(
            AuditRow(
                at=1, who="eve", address="", action="stop", target="car1", detail={}, outcome="done"
            )
        )
    change(filled, copy_of_the_first_event(77))
    assert [fault[:40] for fault in faults(filled)] == [
        "1 line(s) are in no chain: somebody has ",
        "1 event(s) are in no chain: somebody has",
    ]


def test_an_event_that_is_put_in_before_the_first_one_is_found(filled):
    change(filled, copy_of_the_first_event(0))
    assert faults(filled) == ["1 event(s) are in no chain: somebody has put them in: 0"]


@pytest.mark.parametrize("number", [0, -1, -(1 << 63)])
def test_a_line_that_is_put_in_with_a_link_before_the_first_one_is_found(filled, number):
    line = AuditRow(
        at=1, who="eve", address="", action="stop", target="car1", detail={}, outcome="done"
    )
    with filled.session() as session:
        session.add(line)
        session.flush()
        chain = session.scalars(select(ChainRow).where(ChainRow.name == "service")).one()
        session.add(
            ChainLinkRow(chain_id=chain.id, number=number, entry_id=line.id, hash=chain.hash)
        )
    assert f"service: entry {number} is there twice, or before the begin" in faults(filled)


def test_a_cut_off_end_is_found_by_the_head_that_is_stored(filled):
    chain = _chain_id(filled, "events:car2")
    last = ChainLinkRow.chain_id == chain, ChainLinkRow.number == 6
    change(filled, delete(ChainLinkRow).where(*last), delete(EventRow).where(EventRow.id == 12))
    assert faults(filled) == ["events:car2: entry 6 is missing"]


def test_a_robot_with_another_name_is_found(filled):
    change(filled, update(RobotRow).where(RobotRow.name == "car2").values(name="car3"))
    assert [fault[:29] for fault in faults(filled)] == [
        f"events:car2: entry {n} was chan"[:29] for n in range(1, 7)
    ]


# What such an admin can do who computes the hashes, found with a head of before.


def rewrite(database, name, content_of):
    """Compute the hashes of a whole chain again, the head too."""
    with database.session() as session:
        chain = next(each for each in all_chains(session) if each.name == name)
        head = GENESIS
        for link in list(chain_links(session, chain)):
            head = next_head(name, head, content_of(link))
            row = session.get(ChainLinkRow, (chain.id, link.number))
            row.hash = head.hash
        chain.hash = head.hash


def test_a_rewritten_chain_is_found_by_a_head_of_before(filled):
    witnesses = heads(filled)
    change(filled, update(AuditRow).where(AuditRow.id == 5).values(who="john"))
    rewrite(filled, "service", lambda link: link.content)
    assert faults(filled) == []
    assert faults(filled, witnesses) == [
        "service: entry 6, or one before it, was another: it does not fit the head of noon"
    ]
    log(filled)
    assert len(faults(filled, witnesses)) == 1


def test_a_cut_off_end_with_its_head_is_found_by_a_head_of_before(filled):
    witnesses = heads(filled)
    chain = _chain_id(filled, "events:car2")
    with filled.session() as session:
        before = session.get(ChainLinkRow, (chain, 5)).hash
    change(
        filled,
        delete(ChainLinkRow).where(ChainLinkRow.chain_id == chain, ChainLinkRow.number == 6),
        delete(EventRow).where(EventRow.id == 12),
        update(ChainRow).where(ChainRow.id == chain).values(number=5, hash=before),
    )
    assert faults(filled) == []
    (fault,) = faults(filled, witnesses)
    assert fault.startswith("events:car2: entry 6 is missing: they are cut off the end")


def test_a_chain_that_is_gone_is_found_by_a_head_of_before(filled):
    witnesses = heads(filled)
    chain = _chain_id(filled, "events:car2")
    change(
        filled,
        delete(ChainLinkRow).where(ChainLinkRow.chain_id == chain),
        delete(ChainRow).where(ChainRow.id == chain),
        delete(EventRow).where(EventRow.robot_id == 2),
    )
    assert faults(filled) == []
    assert faults(filled, witnesses) == ["the chain events:car2 is gone, but in a head of noon"]


# The retention


def old_and_new(database):
    robot = new_robot(database)
    store_events(database, robot, [make_verdict(n) for n in range(1, 2501)], now=0)
    age_partitions(database)
    store_events(database, robot, [make_verdict(n) for n in (2501, 2502)], now=DAY)


def prune_old(database, refused=None):
    return sum(prune(database, RetentionLimits(max_days=1, max_bytes=1 << 40), 2 * DAY, refused))


def test_the_retention_moves_the_beginning_and_signs_it(aged):
    witnesses = heads(aged)
    assert prune_old(aged) == 2500
    report = next(each for each in check(aged, witnesses).chains if "events" in each.chain)
    assert (report.begin.number, report.end.number, report.compared) == (2500, 2502, 1)
    assert faults(aged, witnesses) == []
    with aged.session() as session:
        assert len(list(session.scalars(select(ChainLinkRow.entry_id)))) == 2


def test_a_chain_of_which_everything_is_deleted_goes_on(database):
    robot = new_robot(database)
    store_events(database, robot, [make_verdict(1)], now=0)
    age_partitions(database)
    assert prune_old(database) == 1
    assert check(database).is_whole
    store_events(database, robot, [make_verdict(2)], now=3 * DAY)
    assert check(database).is_whole
    with database.session() as session:
        assert chain_heads(session)["events:robot"].number == 2


def test_another_beginning_needs_the_key(aged):
    prune_old(aged)
    assert [fault[:46] for fault in faults(aged, keys=())] == [
        "events:robot: entries 1 to 2500 are missing",
        "events:robot: where it begins is not proven: i",
    ]
    with aged.session() as session:
        chain = next(each for each in all_chains(session) if each.anchor)
        chain.anchor = {**chain.anchor, "number": 2501}
    assert "where it begins is not proven: its signature is wrong" in faults(aged)[-1]


def test_events_that_were_changed_to_look_old_stay(database):
    robot = new_robot(database)
    store_events(database, robot, [make_verdict(1), make_verdict(2)], now=DAY)
    age_partitions(database)
    store_events(database, robot, [make_verdict(3), make_verdict(4)], now=DAY)
    change(database, update(EventRow).where(EventRow.id <= 2).values(stored=0))
    assert prune_old(database) == 0
    assert faults(database) == [
        f"events:robot: entry {n} was changed, or is not where it was" for n in (1, 2)
    ]


def test_the_retention_signs_nothing_over_a_gap_and_keeps_what_is_behind_it(aged):
    change(aged, delete(EventRow).where(EventRow.id == 1500))
    gap = "entry 1500 is gone, only its hash is left"
    fitting = 1499 if aged.is_sqlite else 0
    for deleted in (fitting, 0):
        refused = {}
        assert prune_old(aged, refused) == deleted
        assert refused == {"events:robot": gap if fitting == 0 else "entry 1500 is missing"}
        assert faults(aged) == [f"events:robot: {gap}"]
        report = next(each for each in check(aged).chains if each.chain == "events:robot")
        assert report.begin.number == fitting


# Who deletes the beginning of a chain, and lets the retention hide it.


def three_days(database):
    """Make a robot with two events a day on three days, each day in partitions of its own."""
    robot = new_robot(database)
    for day in range(3):
        new = [make_verdict(2 * day + 1), make_verdict(2 * day + 2)]
        store_events(database, robot, new, now=day * DAY)
        age_partitions(database)
    return robot


def delete_beginning(database, number):
    """Delete the oldest entries of a chain with all that is known of them; return the new begin."""
    chain = _chain_id(database, "events:robot")
    with database.session() as session:
        link = session.get(ChainLinkRow, (chain, number))
        begin = {"number": link.number, "hash": link.hash}
        old = ChainLinkRow.chain_id == chain, ChainLinkRow.number <= number
        ids = list(session.scalars(select(ChainLinkRow.entry_id).where(*old)))
    change(database, delete(ChainLinkRow).where(*old), delete(EventRow).where(EventRow.id.in_(ids)))
    return begin


def set_anchor(database, anchor):
    with database.session() as session:
        session.get(ChainRow, _chain_id(database, "events:robot")).anchor = anchor


def prune_all(database, refused):
    return sum(prune(database, RetentionLimits(max_days=1, max_bytes=1 << 40), 4 * DAY, refused))


@pytest.mark.parametrize("has_been_pruned", [False, True])
def test_a_beginning_that_nobody_has_signed_is_no_beginning(database, has_been_pruned):
    three_days(database)
    if has_been_pruned:
        assert prune_old(database) == 2
    set_anchor(database, delete_beginning(database, 3))
    found, refused = faults(database), {}
    fault = "where it begins is not proven: it is no rtron.audit_anchor/1"
    assert f"events:robot: {fault}" in found
    assert prune_all(database, refused) == 0
    assert refused == {"events:robot": fault}
    assert faults(database) == found


def forged_anchors():
    """Beginnings that somebody without the key writes in, by what `audit verify` says of them."""
    other = DocumentSigner(Ed25519PrivateKey.generate())
    return {
        "it is signed with another key": lambda name, head: other.sign_anchor(1, name, head),
        "that is of another chain": lambda _, head: SIGNER.sign_anchor(1, "events:other", head),
        "its signature is wrong": lambda name, head: {
            **SIGNER.sign_anchor(1, name, GENESIS),
            "number": head.number,
        },
    }


def test_a_beginning_with_a_wrong_signature_is_no_beginning(database):
    three_days(database)
    begin = Head(**delete_beginning(database, 3))
    for fault, forge in forged_anchors().items():
        set_anchor(database, forge("events:robot", begin))
        refused = {}
        assert prune_all(database, refused) == 0
        assert refused == {"events:robot": f"where it begins is not proven: {fault}"}


def test_a_deleted_beginning_without_an_anchor_stays_a_gap(database):
    three_days(database)
    delete_beginning(database, 3)
    refused = {}
    assert prune_all(database, refused) == 0
    assert refused == {"events:robot": "entries 1 to 3 are missing"}
    assert faults(database) == ["events:robot: entries 1 to 3 are missing"]


def test_an_older_signed_beginning_is_a_gap_too(database):
    three_days(database)
    assert prune_old(database) == 2
    with database.session() as session:
        first = session.get(ChainRow, _chain_id(database, "events:robot")).anchor
    delete_beginning(database, 4)
    set_anchor(database, first)
    refused = {}
    assert prune_all(database, refused) == 0
    assert refused == {"events:robot": "entries 3 to 4 are missing"}


def test_what_is_too_much_goes_but_nothing_is_signed_over_it(database):
    three_days(database)
    set_anchor(database, delete_beginning(database, 3))
    found = [fault for fault in faults(database) if "is not proven" in fault]
    assert sum(prune(database, RetentionLimits(max_days=1000, max_bytes=0), 4 * DAY)) > 0
    assert set(found) < set(faults(database))


def test_a_refused_chain_keeps_its_events_and_on_postgresql_their_partition(database):
    three_days(database)
    other = new_robot(database, "other")
    events = [make_verdict(n) for n in range(1, 6)]
    store_events(database, other, events, now=0, robot="other")
    age_partitions(database)
    set_anchor(database, delete_beginning(database, 3))
    refused = {}
    assert prune_all(database, refused) == (5 if database.is_sqlite else 0)
    assert list(refused) == ["events:robot"]


def test_a_beginning_may_be_signed_by_another_key_that_is_trusted(aged):
    prune_old(aged)
    age_partitions(aged)
    store_events(aged, 1, [make_verdict(2503)], now=4 * DAY)
    successor = DocumentSigner(Ed25519PrivateKey.generate(), [SIGNER.public_key])
    limits = RetentionLimits(max_days=1, max_bytes=1 << 40)
    assert sum(prune(aged, limits, 4 * DAY, signer=successor)) == 2
    assert check(aged, keys=successor.trusted_keys).is_whole


def test_events_of_before_the_chains_are_not_held_against_them(database):
    robot = new_robot(database)
    store_events(database, robot, [make_verdict(1), make_verdict(2)], now=0)
    age_partitions(database)
    change(database, delete(ChainLinkRow), delete(ChainRow).where(ChainRow.name == "events:robot"))
    store_events(database, robot, [make_verdict(3)], now=DAY)
    assert check(database).is_whole
    assert prune_old(database) == 2
    assert check(database).is_whole
