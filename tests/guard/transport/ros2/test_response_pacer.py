"""Answers go a few at a time, in order, and none is kept."""

from rtron.guard.core.event_loop import Loop
from rtron.guard.transport.ros2.pace import AT_ONCE, Pace


def test_a_crowd_of_answers_goes_in_order_and_a_few_at_once():
    loop, sent, rounds = Loop(), [], []
    pace = Pace(loop)
    for number in range(3 * AT_ONCE + 1):
        pace.send(lambda number=number: sent.append(number))
    assert sent == list(range(AT_ONCE))
    while len(sent) <= 3 * AT_ONCE:
        before = len(sent)
        loop.step(1)
        if len(sent) > before:
            rounds.append(len(sent) - before)
    assert sent == list(range(3 * AT_ONCE + 1))
    assert rounds == [AT_ONCE, AT_ONCE, 1]
    loop.close()
