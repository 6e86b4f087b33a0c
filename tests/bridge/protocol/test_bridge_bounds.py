"""Rates, queues and what waits for slow readers: exact at their bounds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.bridge.protocol.client_state import RefusalCounter, TokenBucket, message_bucket
from rtron.bridge.protocol.outbox import MAX_ANSWERS, Outbox
from rtron.bridge.protocol.subscriptions import MAX_SUBSCRIPTIONS, SubscribeOptions, TopicReader
from rtron.bridge.rights.document import SubscribeRight
from rtron.errors import WireError
from rtron.vocabulary import SECOND

MS = SECOND // 1000


def reader(rate=1000.0, **document):
    made = TopicReader(SubscribeRight(topic="/a", type="std_msgs/String", rate=rate))
    made.subscribe("one", SubscribeOptions.of(document, 10))
    return made


def test_a_bucket_lets_its_burst_pass_and_then_its_rate():
    bucket = TokenBucket(10, 5)
    assert [bucket.take(0) for _ in range(6)] == [True] * 5 + [False]
    assert not bucket.take(SECOND // 10 - 1)
    assert bucket.take(SECOND // 10)
    assert not bucket.take(SECOND // 10)


@given(
    rate=st.sampled_from([0.5, 1.0, 10.0, 200.0]),
    gaps=st.lists(st.sampled_from([0, 1, MS, SECOND // 10 - 1, SECOND // 10, SECOND, 5 * SECOND])),
)
def test_a_bucket_never_lets_more_pass_than_rate_and_burst(rate, gaps):
    bucket = message_bucket(rate)
    now, taken = 0, []
    for gap in gaps:
        now += gap
        if bucket.take(now):
            taken.append(now)
    for first, start in enumerate(taken):
        for last in range(first, len(taken)):
            allowed = (taken[last] - start) * rate / SECOND + bucket.burst
            assert last - first + 1 <= allowed + 1e-6


def test_a_clock_that_goes_back_gives_nothing():
    bucket = TokenBucket(1, 1)
    assert bucket.take(10 * SECOND)
    assert not bucket.take(SECOND)
    assert not bucket.take(11 * SECOND - 1)
    assert bucket.take(11 * SECOND)


def test_more_than_the_burst_never_fits():
    assert not TokenBucket(10, 5).take(10**18, 6)


def test_a_refusal_is_said_once_a_second_and_the_others_are_counted():
    counter = RefusalCounter()
    assert counter.count("a", 0) == 0
    assert counter.count("a", 0) is None
    assert counter.count("a", SECOND - 1) is None
    assert counter.count("b", SECOND - 1) == 0
    assert counter.count("a", SECOND) == 2


def test_the_reasons_that_are_remembered_are_bounded():
    counter = RefusalCounter(max_reasons=3)
    assert [counter.count(str(n), 0) for n in range(5)] == [0, 0, 0, None, None]
    assert counter.count("4", SECOND) == 0


def drain(outbox):
    return [outbox.pop() for _ in range(len(outbox))]


def test_the_oldest_messages_make_room_and_are_counted():
    outbox = Outbox(2, 1000)
    outbox.put_answer("answer")
    for number in range(5):
        outbox.put_message([f"m{number}"])
    assert outbox.dropped == 3
    assert drain(outbox) == ["answer", "m3", "m4"]
    assert (outbox.take_dropped(), outbox.take_dropped()) == (3, 0)


def test_a_message_in_fragments_is_dropped_as_a_whole():
    outbox = Outbox(1, 1000)
    outbox.put_message(["a1", "a2"])
    outbox.put_message(["b1", "b2"])
    assert drain(outbox) == ["b1", "b2"]


def test_a_message_that_has_begun_to_be_sent_is_not_dropped():
    outbox = Outbox(1, 1000)
    outbox.put_message(["a1", "a2"])
    assert outbox.pop() == "a1"
    outbox.put_message(["b1"])
    outbox.put_message(["c1"])
    assert drain(outbox) == ["a2", "c1"]
    assert outbox.dropped == 1


def test_bytes_are_bounded_but_the_last_message_stays():
    outbox = Outbox(100, 10)
    outbox.put_message(["x" * 8])
    outbox.put_message(["y" * 50])
    assert drain(outbox) == ["y" * 50]


@given(st.lists(st.sampled_from(["message", "answer", "pop"]), max_size=60))
def test_an_outbox_never_holds_more_than_its_bounds(steps):
    outbox, put, popped = Outbox(3, 1000), 0, 0
    for step in steps:
        if step == "pop" and outbox:
            popped += outbox.pop() == "m"
        elif step == "message":
            outbox.put_message(["m"])
            put += 1
        elif step == "answer":
            outbox.put_answer("a")
    waiting = drain(outbox).count("m")
    assert waiting <= 3
    assert put == popped + waiting + outbox.dropped


def test_answers_that_nobody_reads_are_too_many_at_some_time():
    outbox = Outbox(10, 1 << 20)
    for _ in range(MAX_ANSWERS):
        outbox.put_answer("a")
    assert not outbox.is_overfull
    outbox.put_answer("a")
    assert outbox.is_overfull
    outbox.pop()
    assert not outbox.is_overfull


def test_answers_that_are_too_large_together_are_too_many():
    outbox = Outbox(10, 100)
    outbox.put_answer("a" * 101)
    assert outbox.is_overfull


def test_messages_within_the_throttle_are_left_out_without_a_queue():
    topic = reader(throttle_rate=100)
    assert topic.take(b"1", 0) == b"1"
    assert topic.take(b"2", 100 * MS - 1) is None
    assert topic.next_at is None
    assert topic.take(b"3", 100 * MS) == b"3"


def test_messages_wait_in_a_queue_and_the_oldest_makes_room():
    topic = reader(throttle_rate=100, queue_length=2)
    assert [topic.take(each, 0) for each in (b"1", b"2", b"3", b"4")] == [b"1", None, None, None]
    assert topic.next_at == 100 * MS
    assert topic.take_due(100 * MS - 1) is None
    assert topic.take_due(100 * MS) == b"3"
    assert topic.take(b"5", 100 * MS) is None
    assert topic.take_due(200 * MS) == b"4"
    assert topic.take_due(300 * MS) == b"5"
    assert topic.next_at is None


def test_a_message_does_not_overtake_those_that_wait():
    topic = reader(throttle_rate=100, queue_length=2)
    topic.take(b"1", 0)
    topic.take(b"2", 1)
    assert topic.take(b"3", 500 * MS) is None
    assert topic.take_due(500 * MS) == b"2"


def test_no_client_reads_faster_than_its_right():
    topic = reader(rate=10.0)
    assert [topic.take(b"m", n * 10 * MS) is not None for n in range(21)].count(True) == 3


def test_the_most_demanding_subscription_counts():
    topic = reader(throttle_rate=500, queue_length=1, fragment_size=1000)
    topic.subscribe("two", SubscribeOptions.of({"throttle_rate": 200, "queue_length": 5}, 10))
    options = topic.options
    assert (options.throttle, options.queue, options.fragment) == (200 * MS, 5, 1000)
    assert not topic.unsubscribe("two")
    assert topic.options.throttle == 500 * MS
    assert topic.unsubscribe("one")


def test_a_subscription_that_is_not_there_cannot_end():
    topic = reader()
    with pytest.raises(WireError, match="no subscription 'x'"):
        topic.unsubscribe("x")
    assert topic.unsubscribe(None)


def test_the_subscriptions_to_a_topic_are_bounded():
    topic = reader()
    for number in range(MAX_SUBSCRIPTIONS - 1):
        topic.subscribe(number, SubscribeOptions())
    with pytest.raises(WireError, match="has 32 subscriptions"):
        topic.subscribe("more", SubscribeOptions())
    topic.subscribe("one", SubscribeOptions(queue=1))


@pytest.mark.parametrize(
    ("document", "reason"),
    [
        ({"compression": "cbor-raw"}, "there is no compression 'cbor-raw' here"),
        ({"compression": ["png"]}, "there is no compression"),
        ({"throttle_rate": -1}, "`throttle_rate` is no whole number"),
        ({"queue_length": "many"}, "`queue_length` is no whole number"),
        ({"fragment_size": 0.5}, "`fragment_size` is no whole number"),
    ],
)
def test_options_that_are_none_are_refused(document, reason):
    with pytest.raises(WireError, match=reason):
        SubscribeOptions.of(document, 10)


def test_options_are_bounded():
    options = SubscribeOptions.of({"throttle_rate": 10**30, "queue_length": 10**30}, 10)
    assert options.queue == 10
    assert options.throttle == 3600 * SECOND
