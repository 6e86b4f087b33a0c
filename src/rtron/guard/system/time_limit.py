"""Work with a time limit, in a task that can be cancelled at any moment."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

_T = TypeVar("_T")


async def run_within(work: Coroutine[Any, Any, _T], limit_s: float) -> _T:
    """Return the result of `work`; cancel it and raise asyncio.TimeoutError if it takes longer.

    In Python 3.10 and 3.11 `asyncio.wait_for` ignores a cancellation that comes when the work has
    just ended. A task that calls it in a loop then never ends, and its owner waits for ever.
    """
    task = asyncio.ensure_future(work)
    try:
        await asyncio.wait([task], timeout=limit_s)
    finally:
        if not task.done():
            task.cancel()
            await asyncio.wait([task])
        if not task.cancelled():
            task.exception()  # if nobody is left to take it, it is no failure
    if task.cancelled():
        raise asyncio.TimeoutError
    return task.result()
