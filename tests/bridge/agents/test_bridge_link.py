"""An agent's connection to a bridge on real sockets."""

import asyncio

import pytest
from bridge_parts import TOKEN
from harness import free_port
from memory_bridge import memory_bridge

from rtron.bridge.agents import bridge_link
from rtron.bridge.agents.bridge_link import BridgeLink
from rtron.errors import SourceError


def sign_in(port, node, token=TOKEN):
    """Open a link twice, and return what it may use of the graph each time."""

    async def use():
        link = BridgeLink(node, f"ws://127.0.0.1:{port}/", token, lambda *_: None)
        found = []
        for _ in range(2):
            await link.open()
            found.append((await link.call("/rosapi/topics", {}))["topics"])
            await link.close()
        assert not link.is_open
        return found

    return asyncio.run(use())


def test_it_signs_in_with_the_token_of_its_node_again_and_again():
    with memory_bridge() as bridge:
        first, second = sign_in(bridge.port, "/bridge/web")
    assert first == second
    assert "/chat" in first


def test_it_does_not_speak_as_somebody_else():
    with memory_bridge() as bridge:
        with pytest.raises(SourceError, match="is of /bridge/web, not of /bridge/screen") as raised:
            sign_in(bridge.port, "/bridge/screen")
        assert bridge.nodes["web"].done == []
    assert "start again with its name" in str(raised.value)


def test_what_it_was_refused_once_it_does_not_try_again():
    async def try_twice(link):
        for _ in range(2):
            with pytest.raises(SourceError, match="is of /bridge/web"):
                await link.open()

    with memory_bridge() as bridge:
        address = f"ws://127.0.0.1:{bridge.port}/"
        asyncio.run(try_twice(BridgeLink("/bridge/screen", address, TOKEN, lambda *_: None)))
        assert len(bridge.opened) == 1


def test_a_bridge_that_does_not_say_whose_the_token_is_is_told_from_a_wrong_token(monkeypatch):
    monkeypatch.setattr(bridge_link, "NODE_HEADER", "RTron-Other")
    with memory_bridge() as bridge, pytest.raises(SourceError, match="does not say whose"):
        sign_in(bridge.port, "/bridge/web")


def test_a_token_of_nobody_is_refused_with_the_bridges_words():
    with memory_bridge() as bridge, pytest.raises(SourceError, match="the bridge refuses"):
        sign_in(bridge.port, "/bridge/web", "nonsense")


def test_without_a_bridge_it_says_where_it_looked():
    port = free_port()
    with pytest.raises(SourceError, match=f"no bridge at ws://127.0.0.1:{port}/"):
        sign_in(port, "/bridge/web")
