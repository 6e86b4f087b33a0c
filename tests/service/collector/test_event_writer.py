import asyncio
from threading import Event

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

        def store(batches):
            gate.wait(20)
            sizes.append(len(batches))
            return ()

        taken = EventWriter(store, lambda added, events: None)
        half = QueuedBatch(BATCH, MAX_QUEUED_BYTES // 2, lambda stored: None)
        await taken.put(half)
        await taken.put(half)
        third = asyncio.create_task(taken.put(QueuedBatch(BATCH, 1, lambda stored: None)))
        running = asyncio.create_task(taken.run())
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert not third.done()
        gate.set()
        await third
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    run(work())


def test_what_is_larger_than_everything_comes_alone():
    async def work():
        taken = EventWriter(lambda batches: (), lambda added, events: None)
        await taken.put(QueuedBatch(BATCH, 2 * MAX_QUEUED_BYTES, lambda stored: None))

    run(work())


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
