"""Clients of the world that misbehave: they are let go, and the world goes on."""

import struct
from functools import partial
from itertools import count

import pytest
from world_client import KEY, LIMIT, clients, serving

from rtron.demos.world.client import WorldClient
from rtron.demos.world.server import connection_registry, loop
from rtron.demos.world.server.loop import StepClock
from rtron.demos.world.server.protocol import encode_frame
from rtron.errors import SourceError


@pytest.mark.parametrize("key", ["", "wrong", None, 7, ["the key"], "\ud800"])
def test_who_has_no_key_is_no_owner(client, key):
    stranger = client()
    stranger.send({"hello": "owner", "key": key})
    assert stranger.is_dropped()


def test_a_wrong_key_is_told_to_the_caller(path):
    with pytest.raises(SourceError, match="log"):
        WorldClient.connect(path, "wrong", LIMIT)


@pytest.mark.parametrize(
    "data",
    [
        b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n",
        struct.pack("!II", 2, 5) + b"{}hello",
        encode_frame({"hello": "king"}),
        encode_frame({"velocity": [1, 0]}),
        encode_frame({"hello": "base"}) + encode_frame({"velocity": [1e308, "x"]}),
        encode_frame({"hello": "lidar"}) + encode_frame({"velocity": [0, 0]}),
        encode_frame({"hello": "owner", "key": KEY})
        + encode_frame({"order": "reset", "case": "x", "seed": 1}),
        encode_frame({"hello": "owner", "key": KEY}) + encode_frame({"order": "fly"}),
    ],
)
def test_whoever_breaks_the_protocol_is_let_go_and_the_world_goes_on(client, data):
    witness, hostile = client("base"), client()
    hostile.socket.sendall(data)
    assert hostile.is_dropped()
    before = witness.next().head["t"]
    assert witness.until(lambda frame: frame.head["t"] > before)


def test_who_says_nothing_is_let_go(client, monkeypatch):
    monkeypatch.setattr(connection_registry, "HELLO_LIMIT", 0.0)
    assert client().is_dropped()


def test_there_is_a_limit_to_connections(client, monkeypatch):
    monkeypatch.setattr(connection_registry, "MAX_CONNECTIONS", 0)
    assert client().is_dropped()


def test_a_reader_that_sleeps_holds_nobody_up(client):
    sleeper, awake = client("camera"), client("base")
    first = awake.next().head["t"]
    awake.until(lambda frame: frame.head["t"] > first + 5.0)
    shown = [sleeper.next().head["t"] for _ in range(8)]
    assert shown[-1] - shown[0] > 2.0


def test_a_world_that_is_always_late_listens_all_the_same(tmp_path, monkeypatch):
    monkeypatch.setattr(loop, "StepClock", partial(StepClock, wall=count().__next__))
    with serving(tmp_path / "late") as late, clients(late) as connect:
        base, owner = connect("base"), connect("owner", key=KEY)
        base.send({"velocity": [0.1, 0.0]})
        assert owner.until(lambda frame: frame.head["truth"]["commanded"] == [0.1, 0.0])
