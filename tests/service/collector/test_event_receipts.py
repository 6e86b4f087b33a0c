"""What a guard is told of its events, whatever fails in between."""

from collections import deque

from hypothesis import given, settings
from hypothesis import strategies as st

from rtron.service.collector.event_writer import EventReceipts
from rtron.vocabulary import EventKind, GuardEvent
from rtron.wire.common.link_protocol import EventsRefused, Stored


def events(*numbers, run="a"):
    return [GuardEvent(run=run, number=n, at=n, kind=EventKind.OWNER) for n in numbers]


def test_what_is_stored_is_confirmed_by_run():
    receipts = EventReceipts()
    batch = [*events(1, 2), *events(1, run="b")]
    receipts.confirm(batch, receipts.accept(batch))
    assert sorted(each.run for each in receipts.take()) == ["a", "b"]
    assert list(receipts.take()) == []


def test_what_was_queued_behind_a_refusal_is_not_confirmed_before_it_comes_again():
    receipts = EventReceipts()
    assert receipts.accept(events(1, 2)) is not None
    queued = receipts.accept(events(3, 4))
    receipts.refuse(events(1, 2))
    assert receipts.accept(events(5)) is None
    assert list(receipts.take()) == [EventsRefused()]
    again = receipts.accept(events(1, 2, 3))
    receipts.confirm(events(3, 4), queued)
    assert list(receipts.take()) == []
    receipts.confirm(events(1, 2, 3), again)
    assert list(receipts.take()) == [Stored(run="a", number=3)]


def test_a_run_that_came_with_refused_ones_is_refused_too():
    receipts = EventReceipts()
    receipts.accept(events(1))
    receipts.refuse(events(1))
    assert receipts.accept([*events(2), *events(1, 2, run="b")]) is None
    assert receipts.accept(events(3, run="b")) is None
    assert receipts.accept([*events(1, 2), *events(1, 2, 3, run="b")]) is not None


def test_each_refusal_is_told():
    receipts = EventReceipts()
    for _ in range(2):
        assert receipts.accept(events(1)) is not None
        receipts.refuse(events(1))
        assert list(receipts.take()) == [EventsRefused()]


class Way:
    """Events on their way: the spool of a link, the service's queue, and what is stored."""

    def __init__(self):
        self.receipts, self.queue = EventReceipts(), deque()
        self.spool, self.position = [], 0
        self.made, self.stored, self.forgotten = set(), set(), set()

    def happen(self, run):
        made = (run, 1 + sum(each[0] == run for each in self.made))
        self.made.add(made)
        self.spool.append(made)

    def send(self, size):
        """Send what waits behind the position."""
        sent = self.spool[self.position :][:size]
        self.position += len(sent)
        batch = [event for run, number in sent for event in events(number, run=run)]
        number = self.receipts.accept(batch) if batch else None
        if number is not None:
            self.queue.append((batch, number))
        return bool(sent)

    def store(self, is_full):
        """Store the first batch of the queue, or not."""
        if not self.queue:
            return
        batch, number = self.queue.popleft()
        if is_full:
            self.receipts.refuse(batch)
        else:
            self.stored |= {(each.run, each.number) for each in batch}
            self.receipts.confirm(batch, number)

    def hear(self):
        """Let the link hear of it: what is confirmed is forgotten, what is refused sent again."""
        for message in self.receipts.take():
            if isinstance(message, EventsRefused):
                self.position = 0
            else:
                self._forget(message)

    def _forget(self, message):
        gone = [each for each in self.spool if each[0] == message.run and each[1] <= message.number]
        self.forgotten |= set(gone)
        self.position = max(0, self.position - len(gone))
        self.spool = [each for each in self.spool if each not in gone]


STEPS = st.one_of(
    st.tuples(st.just("happen"), st.sampled_from("ab")),
    st.tuples(st.just("send"), st.integers(1, 3)),
    st.tuples(st.just("store"), st.booleans()),
    st.tuples(st.just("hear")),
)


@settings(max_examples=200)
@given(st.lists(STEPS, min_size=5, max_size=40))
def test_nothing_is_forgotten_that_is_not_stored_and_all_is_stored_at_last(steps):
    way = Way()
    for run in "aabba":
        way.happen(run)
    for name, *arguments in steps:
        getattr(way, name)(*arguments)
        assert way.forgotten <= way.stored
    while way.spool:
        while way.send(3):
            """Everything is on its way."""
        while way.queue:
            way.store(is_full=False)
        way.hear()
    assert way.forgotten == way.stored == way.made
