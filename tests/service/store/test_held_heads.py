"""Heads that were kept elsewhere, compared with the chains."""

import pytest
from sqlalchemy import delete, update
from store_data import age_partitions, make_verdict, new_robot, prune, store_events

from rtron.service.domain.hash_chain import Head
from rtron.service.store.chains import chain_heads, contradicted_heads
from rtron.service.store.retention import RetentionLimits
from rtron.service.store.tables import ChainLinkRow, ChainRow

DAY = 86_400_000_000_000
CHAIN = "events:robot"


@pytest.fixture
def held(database):
    """The heads of a chain after each of ten events."""
    robot, heads = new_robot(database), []
    for number in range(1, 11):
        store_events(database, robot, [make_verdict(number)], now=number * DAY)
        age_partitions(database)
        with database.session() as session:
            heads.append(chain_heads(session)[CHAIN])
    return heads


def reasons(database, heads, chain=CHAIN):
    with database.session() as session:
        found = contradicted_heads(session, {chain: heads})
        return {head.number: reason for _, head, reason in found}


def change(database, statement):
    with database.session() as session:
        session.execute(statement, execution_options={"synchronize_session": False})


def test_a_log_that_goes_on_contradicts_none(database, held):
    assert reasons(database, held) == {}
    assert reasons(database, []) == {}


def test_another_hash_is_told(database, held):
    change(database, update(ChainLinkRow).where(ChainLinkRow.number >= 8).values(hash="a" * 64))
    told = reasons(database, held)
    assert told == {n: f"entry {n}, or one before it, was another" for n in (8, 9, 10)}


def test_an_end_that_was_cut_off_is_told(database, held):
    change(database, delete(ChainLinkRow).where(ChainLinkRow.number > 6))
    change(database, update(ChainRow).values(number=6, hash=held[5].hash))
    told = reasons(database, held)
    assert told == {n: f"entries 7 to {n} are missing" for n in (7, 8, 9, 10)}


def test_an_entry_that_is_missing_is_told(database, held):
    change(database, delete(ChainLinkRow).where(ChainLinkRow.number == 4))
    assert reasons(database, held) == {4: "entry 4 is missing"}


def test_a_chain_that_is_gone_is_told(database, held):
    assert reasons(database, [Head(3, "a" * 64)], "events:other") == {3: "the chain is gone"}


def prune_four(database):
    list(prune(database, RetentionLimits(max_days=6, max_bytes=1 << 40), 11 * DAY))


def test_what_the_retention_has_deleted_is_no_change(database, held):
    prune_four(database)
    with database.session() as session:
        assert 0 < session.query(ChainRow).one().anchor["number"] < 10
    assert reasons(database, held) == {}


def test_a_begin_that_nobody_has_signed_hides_nothing(database, held):
    prune_four(database)
    with database.session() as session:
        chain = session.query(ChainRow).one()
        chain.anchor = {**chain.anchor, "number": 9, "hash": "a" * 64}
    change(database, delete(ChainLinkRow).where(ChainLinkRow.number < 10))
    assert "where it begins is not proven" in reasons(database, held)[6]


def test_odd_numbers_harm_nothing(database, held):
    for number, is_told in ((-1, False), (1 << 70, True)):
        assert (number in reasons(database, [Head(number, "a" * 64)])) is is_told
