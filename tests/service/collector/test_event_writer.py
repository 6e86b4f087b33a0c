import asyncio
from threading import Event

from sqlalchemy.exc import OperationalError

from rtron.service.collector.event_writer import (
    MAX_QUEUED_BYTES,
    MAX_TRANSACTION_EVENTS,
    EventWriter,
    QueuedBatch,
)
from rtron.service.store.events import EventBatch

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
