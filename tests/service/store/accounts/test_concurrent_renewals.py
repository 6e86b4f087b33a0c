"""Several renew one token at once, at two replicas: one gets the next secret, and it works."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest
from sqlalchemy import select

from rtron.service.domain.errors import ConflictError
from rtron.service.domain.principal import AccessScope
from rtron.service.store.accounts.tokens import OFFER_TIME, GuardTokens, TokenSpec, create_token
from rtron.service.store.database import Database
from rtron.service.store.tables import AuditRow

MANY = 8


@pytest.fixture
def replicas(database, where, clock):
    """The tokens as two replicas look at them."""
    other = Database(where)
    yield [GuardTokens(database, clock), GuardTokens(other, clock)]
    other.close()


@pytest.fixture
def secret(database, clock):
    """The token of a guard."""
    spec = TokenSpec(name="car1", scopes=[AccessScope.GUARD], robot="car1")
    with database.session() as session:
        return create_token(session, clock(), "test", spec)[1]


def renew(tokens, secret):
    """Return the next secret, or why there is none."""
    try:
        return tokens.renew(secret)
    except ConflictError as error:
        return error


def renew_at_once(replicas, secret):
    """Renew in threads that begin together; return the next secrets, and the refusals."""
    barrier = Barrier(MANY)

    def run(number):
        barrier.wait(60)
        return renew(replicas[number % 2], secret)

    with ThreadPoolExecutor(MANY) as threads:
        answers = list(threads.map(run, range(MANY)))
    refusals = [each for each in answers if isinstance(each, ConflictError)]
    return [each for each in answers if each not in refusals], refusals


def test_one_of_many_gets_the_next_secret_and_nobody_is_locked_out(database, replicas, secret):
    first, second = replicas
    for _ in range(5):
        (renewed,), refusals = renew_at_once(replicas, secret)
        assert len(refusals) == MANY - 1
        assert {str(each) for each in refusals} == {"the token is being renewed by somebody else"}
        assert first.authenticate(secret) == "car1"
        assert second.authenticate(renewed) == "car1"
        assert first.authenticate(secret) is None
        secret = renewed
    with database.session() as session:
        lines = session.scalars(select(AuditRow.id).where(AuditRow.action == "renew token")).all()
    assert len(lines) == 5


def test_a_secret_that_nobody_uses_is_replaced_after_a_while(replicas, secret, clock):
    first, second = replicas
    lost = first.renew(secret)
    clock.now += OFFER_TIME - 1
    assert isinstance(renew(second, secret), ConflictError)
    clock.now += 1
    renewed = second.renew(secret)
    assert first.authenticate(lost) is None
    assert first.authenticate(renewed) == "car1"


def test_a_clock_that_is_set_back_keeps_nobody_from_renewing(replicas, secret, clock):
    replicas[0].renew(secret)
    clock.now -= 365 * 86_400_000_000_000
    assert replicas[1].authenticate(replicas[1].renew(secret)) == "car1"


def test_the_next_secret_is_not_renewed_before_it_is_used(replicas, secret, clock):
    renewed = replicas[0].renew(secret)
    clock.now += OFFER_TIME
    assert isinstance(renew(replicas[1], renewed), ConflictError)
    assert replicas[0].authenticate(renewed) == "car1"
    assert replicas[1].renew(renewed)
