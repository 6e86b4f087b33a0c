import asyncio
from collections import deque
from threading import Event

from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy.exc import OperationalError

from rtron.service.collector.event_writer import (
    MAX_QUEUED_BYTES,
    MAX_TRANSACTION_EVENTS,
    EventReceipts,
    EventWriter,
    QueuedBatch,
)
from rtron.service.store.events import EventBatch
from rtron.vocabulary import EventKind, GuardEvent
from rtron.wire.common.link_protocol import EventsRefused, Stored

BATCH = EventBatch(1, "robot", ())


def run(work):
    return asyncio.run(asyncio.wait_for(work, 60))


async def served(taken, work):
    task = asyncio.create_task(taken.run())
    try:
        return await work
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


def test_nobody_gets_in_while_it_is_full():
    async def work():
        gate, sizes = Event(), []
        storing = asyncio.Event()
        loop = asyncio.get_running_loop()

        def store(batches):
            loop.call_soon_threadsafe(storing.set)
            gate.wait(60)
            sizes.append(len(batches))
            return ()

        taken = EventWriter(store, lambda added, events: None)
        half = QueuedBatch(BATCH, MAX_QUEUED_BYTES // 2, lambda stored: None)
        await taken.put(half)
        await taken.put(half)
        third = asyncio.create_task(taken.put(QueuedBatch(BATCH, 1, lambda stored: None)))
        running = asyncio.create_task(taken.run())
        await storing.wait()
        assert not third.done()
        gate.set()
        await third
        assert sizes[0] == 2
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    run(work())


def test_what_is_larger_than_everything_comes_alone():
    async def work():
        done, stored = asyncio.Event(), []

        def on_stored(is_stored):
            stored.append(is_stored)
            done.set()

        taken = EventWriter(lambda batches: (), lambda added, events: None)
        await taken.put(QueuedBatch(BATCH, 2 * MAX_QUEUED_BYTES, on_stored))
        await served(taken, done.wait())
        return stored

    assert run(work()) == [True]


def test_a_transaction_ends():
    async def work():
        groups, done = [], asyncio.Event()
        batch = EventBatch(1, "robot", (object(),) * (MAX_TRANSACTION_EVENTS // 2))

        def store(batches):
            groups.append(len(batches))
            return ()

        taken = EventWriter(store, lambda added, events: None)
        for last in (False, False, True):
            await taken.put(QueuedBatch(batch, 1, lambda stored, last=last: last and done.set()))
        await served(taken, done.wait())
        return groups

    assert run(work()) == [2, 1]


def test_one_bad_batch_does_not_harm_the_others():
    async def work():
        answers, done = {}, asyncio.Event()
        bad = EventBatch(2, "bad", (object(),))
        good = EventBatch(1, "good", (object(),))

        def store(batches):
            if bad in batches:
                raise ValueError("no")
            return ()

        def answer(name, stored):
            answers[name] = stored
            if len(answers) == 3:
                done.set()

        taken = EventWriter(store, lambda added, events: None)
        for name, batch in (("a", good), ("b", bad), ("c", good)):
            await taken.put(QueuedBatch(batch, 1, lambda stored, name=name: answer(name, stored)))
        await served(taken, done.wait())
        return answers

    assert run(work()) == {"a": True, "b": False, "c": True}


def test_what_comes_a_moment_later_shares_the_next_transaction():
    async def work():
        groups, stored = [], []

        def store(batches):
            groups.append(len(batches))
            return ()

        taken = EventWriter(store, lambda added, events: None)
        running = asyncio.create_task(taken.run())
        loop, now = asyncio.get_running_loop(), asyncio.get_running_loop().time()
        loop.time = lambda: now  # a moment has not passed, however busy the machine is
        for index in range(3):
            done = asyncio.Event()
            stored.append(done)
            await taken.put(QueuedBatch(BATCH, 1, lambda _stored, done=done: done.set()))
            if index == 0:
                await done.wait()
            for _ in range(100):  # turns of the loop, in which a writer that does not wait stores
                await asyncio.sleep(0)
        del loop.time
        await asyncio.gather(*(each.wait() for each in stored))
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        return groups

    assert run(work()) == [1, 2]


def test_if_the_database_is_the_reason_nothing_is_tried_again():
    async def work():
        calls, answers, done = [], [], asyncio.Event()

        def store(batches):
            calls.append(len(batches))
            raise OperationalError("INSERT", {}, Exception("database or disk is full"))

        def answer(is_stored):
            answers.append(is_stored)
            if len(answers) == 3:
                done.set()

        taken = EventWriter(store, lambda added, events: None)
        for _ in range(3):
            await taken.put(QueuedBatch(BATCH, 1, answer))
        await served(taken, done.wait())
        return calls, answers

    assert run(work()) == ([3], [False] * 3)


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
