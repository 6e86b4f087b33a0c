"""Whose requests are whose while strangers tell other names: a graph made by hand."""

from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy")
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.guard.transport.ros2.client_resolver import ClientResolver
from rtron.guard.transport.ros2.participants import NameOwners

pytestmark = pytest.mark.ros2
ONE, GIDS = b"participant1", (b"participant1:001", b"participant1:002")
PLACE = ONE + bytes(12)


class Domain:
    """Who subscribes each topic, as the domain tells it."""

    def __init__(self):
        self.changed, self._names = [], {}
        self.owners = NameOwners()
        self.callers = ClientResolver("/fib", "/one", TypeInfo("t", "m"), self._shared())

    def watch(self, topic):
        pass

    def ends(self, _topic):
        told = self._names.items()
        found = [SimpleNamespace(gid=g, node=n, participant=g[: len(ONE)]) for g, n in told]
        return SimpleNamespace(subscribers=found)

    def tells(self, **names):
        """Tell the names of endpoints from now on."""
        self._names = {GIDS[int(end[-1]) - 1]: name for end, name in names.items()}
        self.owners.update([(name, ONE) for name in names.values()])
        for changed in self.changed:
            changed()

    def peer(self):
        """Return whose a request is."""
        peers = []
        self.callers.resolve(PLACE, peers.append)
        return [(peer.node, peer.verified) for peer in peers]

    def _shared(self):
        loop = SimpleNamespace(now=lambda: 0)
        return SimpleNamespace(graph=self, loop=loop, owners=self.owners)


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
