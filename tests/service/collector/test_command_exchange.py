"""Commands for a guard's leases on their way: each is sent once, and answered or given up."""

from concurrent.futures import Future

import pytest

from rtron.errors import SourceError
from rtron.service.collector.command_exchange import MAX_WAITING, CommandExchange
from rtron.service.domain.errors import TooManyRequestsError
from rtron.wire.common.link_protocol import CommandResponse, LeaseCommand


@pytest.fixture
def exchange():
    made = CommandExchange()
    made.understood = (LeaseCommand,)
    return made


def add(exchange, number):
    response = Future()
    command = LeaseCommand(number=number, lease="base", do="end", by="ann", grant=1)
    exchange.add(command, response)
    return response


def sent(exchange):
    return [command.number for command in exchange.take()]


def answer(number):
    return CommandResponse(number=number, granted=True, reason="")


def test_each_is_sent_once_and_gets_its_own_answer(exchange):
    first, second = add(exchange, 1), add(exchange, 2)
    assert sent(exchange) == [1, 2]
    assert sent(exchange) == []
    exchange.answer(answer(2))
    assert (first.done(), second.result(0)) == (False, answer(2))


def test_what_nobody_waits_for_any_more_is_not_sent(exchange):
    add(exchange, 1).cancel()
    late = add(exchange, 2)
    assert sent(exchange) == [2]
    late.cancel()
    exchange.answer(answer(2))
    exchange.answer(answer(3))


def test_a_guard_that_does_not_know_them_hears_nothing():
    exchange = CommandExchange()
    with pytest.raises(SourceError, match="does not know such commands"):
        add(exchange, 1).result(0)
    assert sent(exchange) == []


def test_so_many_wait_and_no_more(exchange):
    waiting = [add(exchange, number) for number in range(MAX_WAITING)]
    with pytest.raises(TooManyRequestsError):
        add(exchange, MAX_WAITING).result(0)
    waiting[0].cancel()
    assert not add(exchange, MAX_WAITING + 1).done()


def test_the_end_of_the_connection_is_told(exchange):
    response = add(exchange, 1)
    exchange.close()
    with pytest.raises(SourceError, match="gone before it has answered"):
        response.result(0)
