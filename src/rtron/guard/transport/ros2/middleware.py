"""The guard's transport for ROS 2: many nodes in one participant, raw messages, no executor."""

from __future__ import annotations

import logging
from collections import defaultdict
from typing import TYPE_CHECKING

from rtron.guard.transport.common.protocol import Connect, Lost, Momentary, Output, ignore, never
from rtron.guard.transport.ros2.action_relay import ActionEnds
from rtron.guard.transport.ros2.canceller import Canceller
from rtron.guard.transport.ros2.context import Surroundings
from rtron.guard.transport.ros2.graph import Graph
from rtron.guard.transport.ros2.owners import Owners
from rtron.guard.transport.ros2.participants import Lives
from rtron.guard.transport.ros2.process_table import Processes
from rtron.guard.transport.ros2.publication import Publication
from rtron.guard.transport.ros2.rcl import Rcl
from rtron.guard.transport.ros2.subscription import Subscription, Terms
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import SECOND
from rtron.wire.ros2.interfaces import interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.action.ros2.endpoints import Hears
    from rtron.guard.core.event_loop import Loop
    from rtron.vocabulary import Stream
    from rtron.wire.ros2.session import Session

log = logging.getLogger(__name__)

_SETTLED = 4 * SECOND
"""Fast DDS repeats its announcements every 3 s."""


class Ros2Transport:
    """Nodes, topics and a clock on ROS 2; everything happens in the loop's thread."""

    encoding = Encoding.CDR

    def __init__(self, loop: Loop, session: Session) -> None:
        self.session = session
        self.rcl = Rcl()
        self.graph = Graph(loop, session, self.rcl)
        self.processes = Processes()
        lives, self._owners = Lives(self.graph.participant, self.processes), Owners()
        self._began = loop.now()
        self.now = loop.now
        self.call_at = loop.call_at
        self._shared = Surroundings(loop, self.rcl, self.graph, self._owners, lives, _log)
        self._publications: list[Publication] = []
        self._subscriptions: list[Subscription] = []
        self._actions: list[ActionEnds] = []
        self.graph.changed.append(self._look_at_names)

    def tell(self, complain: Callable[[str, str, str], None]) -> None:
        """Tell what is not heard (topic, node, why) here instead of in the log."""
        self._shared.complain = complain

    def advertise(
        self,
        node: str,
        topic: str,
        type: str,
        *,
        queue_size: int = 100,
        successors: tuple[str, ...] = (),
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`."""
        return self._publication(node, topic, type, queue_size, successors)

    def subscribe(
        self,
        node: str,
        topic: str,
        type: str,
        connect: Connect,
        lost: Lost = ignore,
        *,
        momentary: Momentary = never,
        publishers: tuple[str, ...] = (),
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`."""
        own = self.session.node(node)
        terms = Terms(connect, lost, momentary, publishers)
        made = Subscription(own, topic, type, terms, self._shared)
        self._subscriptions.append(made)

    def action_ends(self, stream: Stream, node: str, hears: Hears) -> ActionEnds:
        """Return the services and topics of an action; see `CarriesRequests`."""
        ends = ActionEnds(stream, self.session.node(node), hears, self._shared)
        self._actions.append(ends)
        return ends

    def canceller(self, node: str, action: str) -> Canceller:
        """Return what cancels goals of an action that has no guard; see `CarriesCancels`."""
        return Canceller(self.session.node(node), action)

    def join(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Show two nodes of ours as connected; see `Transport`."""
        output = self._publication(publisher, topic, type)
        if type:
            output.own_readers = 1
            node = self.session.node(subscriber)
            node.create_subscription(interface(type).cls, topic, lambda _: None, 1, raw=True)
        return output

    def close(self) -> None:
        """Leave the domain."""
        self.graph.close()
        for subscription in self._subscriptions:
            subscription.close()
        for publication in self._publications:
            publication.close()
        for action in self._actions:
            action.close()
        self.session.close()

    def _publication(
        self,
        node: str,
        topic: str,
        type: str,
        queue_size: int = 100,
        successors: tuple[str, ...] = (),
    ) -> Publication:
        publication = Publication(
            self.session.node(node),
            topic,
            type,
            self._shared,
            queue_size=queue_size,
            successors=successors,
        )
        self._publications.append(publication)
        return publication

    def _look_at_names(self) -> None:
        """Know whose each name is, before anybody asks; the dead have none any more."""
        settled = self.now() - self._began > _SETTLED
        self._owners.look(self._named_living(), settled=settled)

    def _named_living(self) -> list[tuple[str, bytes]]:
        """Return each node name with each participant that has it; who is gone may have it alone.

        Clients and servers of actions have their names at what they subscribe, too.
        """
        lives, watched = self._shared.lives, self.graph.watched()
        ends = [end for each in watched for end in (*each.publishers, *each.subscribers)]
        lives.look((end.participant for end in ends), self.now())
        found: dict[str, set[bytes]] = defaultdict(set)
        for end in ends:
            found[end.node].add(end.participant)
        crowds = (group for node, group in found.items() if node and len(group) > 1)
        gone = {each for group in crowds for each in group - lives.living(group)}
        return [(node, each) for node, group in found.items() for each in group - gone]


def _log(topic: str, node: str, why: str) -> None:
    log.error("%s: %s %s", topic, node or "a node without a name", why)
