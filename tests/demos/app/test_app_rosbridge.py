"""What stands for rosbridge in the demo, with a client of the library as its client."""

import json
from queue import Queue

import pytest
from harness import LIMIT_S, wait_for
from websockets.sync.client import connect

from rtron.demos.apps.logic.demo_logic.rosbridge import Rosbridge
from rtron.demos.runtime.isolation import free_port

DRIVE = {"linear": {"x": 0.8}, "angular": {"z": 0.0}}


@pytest.fixture
def bridge():
    came = Queue()
    with Rosbridge(free_port(), lambda topic, message: came.put((topic, message))) as server:
        yield server, came
        server.shutdown()


def client(server):
    host, port = server.server_address
    return connect(f"ws://{host}:{port}/", compression=None, proxy=None)


@pytest.mark.parametrize("padding", [0, 200, 70_000])
def test_whoever_connects_may_publish(bridge, padding):
    server, came = bridge
    message = DRIVE | {"padding": "x" * padding}
    with client(server) as socket:
        socket.send(json.dumps({"op": "advertise", "topic": "/cmd_vel"}))
        socket.send(json.dumps({"op": "publish", "topic": "/cmd_vel", "msg": message}))
        assert came.get(timeout=LIMIT_S) == ("/cmd_vel", message)


@pytest.mark.parametrize("padding", [0, 200])
def test_all_clients_hear_what_is_sent(bridge, padding):
    server, _ = bridge
    with client(server) as one, client(server) as other:
        wait_for(lambda: len(server._clients) == 2)
        server.send("/odom", {"padding": "x" * padding})
        for each in (one, other):
            frame = json.loads(each.recv(timeout=LIMIT_S))
            assert frame == {"op": "publish", "topic": "/odom", "msg": {"padding": "x" * padding}}


def test_a_client_that_leaves_is_forgotten(bridge):
    server, _ = bridge
    with client(server):
        wait_for(lambda: server._clients)
    wait_for(lambda: not server._clients)
