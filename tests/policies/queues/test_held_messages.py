import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.policies.queues.held_messages import HeldMessageQueue
from rtron.vocabulary import Flow

LOW = Flow(name="low", publisher="/low", priority=1)
HIGH = Flow(name="high", publisher="/high", priority=2)


def waiting():
    return HeldMessageQueue(lambda flow: -flow.priority)


def test_the_next_and_the_oldest():
    queue = waiting()
    assert (queue.first(), queue.oldest(), len(queue)) == (None, None, 0)
    for number, flow in enumerate((LOW, HIGH, HIGH, LOW)):
        queue.add(flow, number, number)
    assert (queue.first().message, queue.oldest().message, len(queue)) == (1, 0, 4)


def test_a_refreshed_message_keeps_its_place_and_gets_younger():
    queue = waiting()
    queue.add(LOW, "old", 0)
    queue.add(HIGH, "other", 1)
    queue.replace_message(queue.latest("low"), "new", 2)
    assert queue.oldest().message == "other"
    assert (queue.latest("low").message, queue.latest("low").arrived_at) == ("new", 2)


def test_nothing_overtakes_the_chosen_one():
    queue = waiting()
    queue.pin_first()
    queue.add(LOW, "chosen", 0)
    queue.pin_first()
    queue.add(HIGH, "higher", 1)
    assert queue.first().message == "chosen"
    queue.remove(queue.first())
    assert queue.first().message == "higher"


@given(st.permutations(range(60)), st.integers(0, 59))
def test_the_order_survives_what_is_removed(priorities, kept):
    queue = waiting()
    for priority in priorities:
        queue.add(Flow(name=str(priority), publisher="/any", priority=priority), None, 0)
    for priority in priorities[kept:]:
        queue.remove(queue.latest(str(priority)))
    for priority in sorted(priorities[:kept], reverse=True):
        assert queue.first().flow.priority == priority
        queue.remove(queue.first())
    assert queue.first() is None


def test_what_was_removed_below_the_top_does_not_pile_up():
    queue = waiting()
    queue.add(HIGH, "stays", 0)
    for number in range(1000):
        queue.add(LOW, number, number)
        queue.remove(queue.latest("low"))
    assert len(queue._heap) < 50
    assert queue.first().message == "stays"
    assert queue.latest("low") is None


@pytest.mark.parametrize("kept", [1, 2, 5, 40])
def test_what_was_removed_makes_up_no_more_than_half_of_the_heap_and_a_few(kept):
    queue = waiting()
    for number in range(kept):
        queue.add(HIGH, number, number)
    for number in range(200):
        queue.add(LOW, number, number)
        queue.remove(queue.latest("low"))
        assert len(queue._heap) <= 2 * kept + 16


def test_the_heap_is_not_built_anew_for_a_few():
    queue = waiting()
    queue.add(HIGH, "stays on top", 0)
    heap = queue._heap
    for number in range(16):
        queue.add(LOW, number, number)
        queue.remove(queue.latest("low"))
    assert queue._heap is heap
    assert len(heap) == 17
