"""Work with a time limit: its result, its error, its end, and a cancellation at every moment."""

import asyncio
from contextlib import suppress

import pytest
from cancelled_tasks import assert_ends_when_cancelled

from rtron.guard.system.time_limit import run_within

LONG_S = 3600.0


async def give(value):
    await asyncio.sleep(0)
    return value


async def fail():
    await asyncio.sleep(0)
    raise OSError("gone")


def test_the_result_is_that_of_the_work():
    assert asyncio.run(run_within(give(3), LONG_S)) == 3


def test_an_error_is_that_of_the_work():
    with pytest.raises(OSError, match="gone"):
        asyncio.run(run_within(fail(), LONG_S))


def test_work_that_takes_too_long_is_cancelled():
    async def run():
        ended = asyncio.Event()

        async def hang():
            try:
                await asyncio.sleep(LONG_S)
            finally:
                ended.set()

        with pytest.raises(asyncio.TimeoutError):
            await run_within(hang(), 0.01)
        return ended.is_set()

    assert asyncio.run(run())


@pytest.mark.parametrize("work", [lambda: give(3), fail, lambda: asyncio.sleep(LONG_S)])
def test_a_cancellation_at_any_moment_counts(work):
    async def repeat():
        while True:
            with suppress(OSError):
                await run_within(work(), LONG_S)
            await asyncio.sleep(LONG_S)

    assert_ends_when_cancelled(repeat)


def test_cancelled_work_is_not_left_behind():
    async def run():
        task = asyncio.create_task(run_within(asyncio.sleep(LONG_S), LONG_S))
        await asyncio.sleep(0)
        task.cancel()
        await asyncio.wait([task])
        return asyncio.all_tasks() - {asyncio.current_task()}

    assert asyncio.run(run()) == set()
