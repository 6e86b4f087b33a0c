"""A service that passes between a cell and the app, without a cell."""

import socket

from rtron.guard.cell.ros1.service_relay import ServiceRelay, ServiceSide
from rtron.guard.cell.topic_relay import CellRefusals
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import CarriedService
from rtron.wire.ros1.network import HOST_NETWORK

HOST = "127.0.0.1"


def side(master):
    return ServiceSide(master=master, network=HOST_NETWORK, host=HOST, node="/n", node_uri="")


def test_a_master_that_hangs_is_asked_once_at_a_time():
    loop = EventLoop()
    with socket.create_server((HOST, 0)) as hanging:
        hanging.settimeout(0)
        here = side(f"http://{HOST}:{hanging.getsockname()[1]}/")
        refusals = CellRefusals("/n", loop.now)
        relay = ServiceRelay(loop, CarriedService(service="/s"), (here, here), refusals)
        asked = []
        loop.watch(hanging, lambda: asked.append(hanging.accept()), lambda _: None)
        loop.call_later(1.6, loop.stop)
        loop.run()
        relay.close()
        assert len(asked) == 1
        for sock, _ in asked:
            sock.close()
        loop.unwatch(hanging)
    loop.close()
