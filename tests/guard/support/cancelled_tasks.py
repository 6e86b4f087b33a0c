"""A task that is cancelled after every step of its first ones must end."""

import asyncio

_MOMENTS = 30
_STEPS_TO_END = 1000
"""Turns of the loop, not seconds: a machine that stalls has no part in it."""


def assert_ends_when_cancelled(work, meanwhile=lambda _step: None):
    """Run `work()` anew for every moment to cancel it; `meanwhile` is called before every turn."""

    async def ends_after(moment):
        task = asyncio.ensure_future(work())
        for step in range(moment):
            meanwhile(step)
            await asyncio.sleep(0)
        task.cancel()
        for _ in range(_STEPS_TO_END):
            if task.done():
                return task.cancelled()
            await asyncio.sleep(0)
        return False

    lost = [moment for moment in range(_MOMENTS) if not asyncio.run(ends_after(moment))]
    assert lost == [], "a cancellation after these turns of the loop is lost"
