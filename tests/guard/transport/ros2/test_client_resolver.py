"""Whose requests are whose while strangers tell other names: a graph made by hand."""

from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.guard.transport.ros2.client_resolver import ClientResolver
from rtron.guard.transport.ros2.participants import NameOwners
from rtron.guard.transport.ros2.sender_ids import GraphSenderIds

pytestmark = pytest.mark.ros2
ONE, GIDS = b"participant1", (b"participant1:001", b"participant1:002")
REQUEST_ID = ONE + bytes(12)


class Domain:
    """Who subscribes each topic, as the domain tells it."""

    def __init__(self):
        self.listeners, self._names = [], {}
        self.owners = NameOwners()
        self.resolver = ClientResolver("/fib", "/one", TypeInfo("t", "m"), self._context())

    def watch(self, topic):
        pass

    def endpoints(self, _topic):
        subscribers = [
            SimpleNamespace(gid=gid, node=node, participant=gid[: len(ONE)])
            for gid, node in self._names.items()
        ]
        return SimpleNamespace(subscribers=subscribers)

    def tells(self, **names):
        """Tell the names of endpoints from now on."""
        self._names = {GIDS[int(end[-1]) - 1]: name for end, name in names.items()}
        self.owners.update([(name, ONE) for name in names.values()])
        for listener in self.listeners:
            listener()

    def peer(self):
        """Return whose a request is."""
        peers = []
        self.resolver.resolve(REQUEST_ID, peers.append)
        return [(peer.node, peer.verified) for peer in peers]

    def _context(self):
        loop = SimpleNamespace(now=lambda: 0)
        return SimpleNamespace(
            graph=self, loop=loop, owners=self.owners, sender_ids=GraphSenderIds()
        )


def test_an_approved_client_keeps_its_name_whatever_it_is_called():
    domain = Domain()
    domain.tells(end1="/one")
    domain.tells(end1="/other")
    assert domain.peer() == [("/one", True)]
    domain.tells(end1="")
    assert domain.peer() == [("/one", True)]


def test_another_client_s_name_is_what_the_domain_tells():
    domain = Domain()
    domain.tells(end1="/other")
    assert domain.peer() == [("/other", False)]
    domain.tells(end1="/one")
    assert domain.peer() == [("/one", True)]


def test_a_name_is_forgotten_with_its_endpoint():
    domain = Domain()
    domain.tells(end1="/one")
    domain.tells(end2="/other")
    assert domain.peer() == [("/other", False)]
    domain.tells(end1="/other")
    assert domain.peer() == [("/other", False)]
