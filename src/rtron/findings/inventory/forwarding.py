"""What stands behind commands: which others lead to them, by whom, and what nobody tells."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.app_flow import AppFlow
from rtron.findings.inventory.doors import operators
from rtron.findings.inventory.node_roles import NodeRoles
from rtron.findings.inventory.things import is_order
from rtron.findings.node_kinds import priorities
from rtron.vocabulary import ActionRole, Trust, WiringFactKind
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Command, Means

_MOST_HOPS = 6


@dataclass(frozen=True)
class Forwarding:
    """Tells how commands go from node to node."""

    app: AppFacts
    roles: NodeRoles
    flow: AppFlow

    def command(self, topic: str, hops: int = 0) -> Command:
        """Return the command that a topic is."""
        facts, handing = self.app.facts.topic(topic), self.flow.led
        receivers = self.flow.obeying.get(topic) or tuple(
            node for node in self.app.readers(topic) if handing(node, topic)
        )
        return Command(
            means=Means.TOPIC,
            name=topic,
            type=facts.type,
            receivers=receivers,
            senders=facts.publishers,
            hops=hops,
        )

    def behind(self, commands: Iterable[Command]) -> Iterator[tuple[str, Command]]:
        """Yield each topic behind commands that leads to them, with the node that hands it on."""
        level = tuple(commands)
        seen, hops = {command.name for command in level}, 0
        while level and hops < _MOST_HOPS:
            names, hops, further = frozenset(c.name for c in level), hops + 1, list[Command]()
            for node in dict.fromkeys(node for c in level for node in c.senders):
                ranks = self.flow.ranks.get(node, {})
                for topic in self.flow.inputs(node, names):
                    if topic not in seen:
                        seen.add(topic)
                        found = self.command(topic, hops)
                        further.append(found)
                        yield node, replace(found, priority=ranks.get(topic, ""))
            level = tuple(further)

    def before(self, command: Command) -> list[Command]:
        """Return the commands behind one."""
        return [each for _, each in self.behind([command])]

    def buttons(self, requests: Iterable[Command]) -> Iterator[Command]:
        """Yield the signals, texts and joysticks that tell those who call services and actions.

        So does what makes them call, and stands behind all else.
        """
        requests = tuple(requests)
        names = frozenset(each.name for each in requests)
        for node in dict.fromkeys(node for each in requests for node in each.senders):
            for topic in self.flow.inputs(node, names):
                each = self.command(topic)
                is_pressed = each.type in SIGNALS or self.flow.is_by_hand(topic)
                is_near = is_pressed or is_order(each.name, each.type)
                if not is_near and self.flow.programs.way(node, topic) is None:
                    continue
                yield replace(each, hops=1 if is_near else _MOST_HOPS)

    def goals(self, requests: Iterable[Command]) -> Iterator[Command]:
        """Yield the topics from which the servers of actions take goals, too."""
        for node in dict.fromkeys(node for each in requests for node in each.receivers):
            if not self.roles.drives(node):
                for end in self.app.graph.subscribed_by(node):
                    is_used = self.flow.programs.way(node, end.topic) is None
                    is_used |= bool(self.flow.led(node, end.topic))
                    if is_used and self.flow.named.get(end.topic) not in {None, *NO_MOTION}:
                        yield replace(self.command(end.topic, 1), receivers=(node,))

    def unprompted(self, commands: Iterable[Command]) -> tuple[str, ...]:
        """Return the app's own nodes that send commands, and that nothing reaches which tells them.

        What they measure may decide when they begin.
        """
        sent = {(node, command.name) for command in commands for node in command.senders}
        nodes = dict.fromkeys(node for node, _ in sorted(sent))
        return tuple(node for node in nodes if self._is_unprompted(node, sent))

    def _is_unprompted(self, node: str, sent: set[tuple[str, str]]) -> bool:
        is_own = node in self.app.nodes and self.app.nodes[node].trust is Trust.OWN
        if not is_own or node in self._reached or node in self.app.unread_nodes:
            return False
        led = frozenset(name for sender, name in sent if sender == node)
        return not (any(self.flow.inputs(node, led)) or operators(self.app, {node}))

    @cached_property
    def _reached(self) -> frozenset[str]:
        """The nodes that requests, hardware or a network may tell something."""
        graph = self.app.graph
        links = (WiringFactKind.DEVICE, WiringFactKind.SOCKET)
        found = {each.node for each in graph.services if not each.implicit}
        found |= {each.node for each in graph.actions if each.role is ActionRole.SERVER}
        return frozenset(found.union(f.subject for f in graph.wiring if f.kind in links))

    def decides(self, node: str, commands: Iterable[Command]) -> bool:
        """Return whether a node decides between commands: an arbiter, or one that takes several."""
        if node in self.flow.ranks:
            return True
        led = frozenset(c.name for c in commands if node in c.senders)
        return len(list(self.flow.inputs(node, led))) > 1

    def passing_locks(self, nodes: Iterable[str]) -> list[str]:
        """Return the inputs of arbiters that their locks never hold back (twist_mux's README)."""
        found: list[str] = []
        for node in filter(self.flow.ranks.__contains__, nodes):
            locks = priorities(self.app, node, "locks").values()
            ranked = {n: int(r) for n, r in self.flow.ranks[node].items() if r.isdigit()}
            if locks and all(map(str.isdigit, locks)):
                found += (name for name, r in ranked.items() if r >= max(map(int, locks)))
        return found
