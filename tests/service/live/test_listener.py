import asyncio
from threading import Thread

import pytest

from rtron.service.live.hub import Hub
from rtron.service.live.listener import MAX_QUEUED


def live(number):
    return {"number": number}


def run(work):
    return asyncio.run(asyncio.wait_for(work, 60))


def test_messages_come_in_order():
    async def work():
        hub = Hub()
        listener = hub.listen()
        for number in range(3):
            hub.broadcast(live(number))
        return [await listener.__anext__() for _ in range(3)]

    assert run(work()) == [live(0), live(1), live(2)]


@pytest.mark.parametrize("extra", [0, 1])
def test_too_slow_a_listener_is_closed(extra):
    async def work():
        hub = Hub()
        listener = hub.listen()
        for number in range(MAX_QUEUED + extra):
            hub.broadcast(live(number))
        listening = hub.has_listeners
        if listening:
            listener.close()
        return listening, [each async for each in listener]

    assert run(work()) == (not extra, [])


def test_many_threads_tell_one_listener():
    async def work():
        hub = Hub()
        listener = hub.listen()
        threads = [
            Thread(target=lambda: [hub.broadcast(live(number)) for number in range(100)])
            for _ in range(8)
        ]
        for thread in threads:
            thread.start()
        found = [await listener.__anext__() for _ in range(800)]
        for thread in threads:
            thread.join()
        return found

    assert len(run(work())) == 800


def test_a_listener_whose_loop_is_over_harms_nobody():
    hub = Hub()

    async def work():
        return hub.listen()

    run(work())
    for number in range(MAX_QUEUED + 1):
        hub.broadcast(live(number))
    assert not hub.has_listeners
