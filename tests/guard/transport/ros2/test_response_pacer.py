"""Answers go a few at a time, in order, and none is kept."""

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.service_calls import BURST_SIZE, ResponsePacer


def test_a_crowd_of_answers_goes_in_order_and_a_few_at_once():
    loop, sent, rounds = EventLoop(), [], []
    pace = ResponsePacer(loop)
    for number in range(3 * BURST_SIZE + 1):
        pace.send(lambda number=number: sent.append(number))
    assert sent == list(range(BURST_SIZE))
    while len(sent) <= 3 * BURST_SIZE:
        before = len(sent)
        loop.step(1)
        if len(sent) > before:
            rounds.append(len(sent) - before)
    assert sent == list(range(3 * BURST_SIZE + 1))
    assert rounds == [BURST_SIZE, BURST_SIZE, 1]
    loop.close()
