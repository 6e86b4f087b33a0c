"""What the remaps cannot achieve: the ends of the plan's streams that stay open."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rtron.planning.instrument.common.guarded_launch import EnforcementGap
from rtron.planning.instrument.common.remaps import (
    NodeRemaps,
    loaders,
    manager_of,
    public_names,
    stream_role,
)
from rtron.vocabulary import LaunchNode, LaunchTree, Stream, is_bridge_client, matches_node


@dataclass(frozen=True, slots=True)
class RemapCoverage:
    """Looks at one wired launch; each method yields what it finds.

    `unreachable` says of nodes why no remap can be placed on them.
    """

    tree: LaunchTree
    streams: tuple[Stream, ...]
    remaps: NodeRemaps
    unreachable: Mapping[LaunchNode, str] = field(default_factory=dict)

    def gaps(self) -> Iterator[EnforcementGap]:
        """Yield every node of the plan whose end of a stream stays open."""
        for stream in self.streams:
            yield from self._unreachable_nodes(stream)
            yield from self._open_successors(stream)
            yield from self._open_publishers(stream)
            yield from self._inside_managers(stream)
        yield from self._anonymous_spellings()

    def notes(self) -> Iterator[str]:
        """Yield what is worth knowing and leaves no end open."""
        for stream in self.streams:
            yield from self._absent_publishers(stream)
            yield from self._self_delivery(stream)
            yield from self._named_loaders(stream)
            yield from self._unnamed_readers(stream)

    def _unreachable_nodes(self, stream: Stream) -> Iterator[EnforcementGap]:
        for node, why in self.unreachable.items():
            if stream_role(node, stream):
                yield EnforcementGap(what=node.name, why=f"{why}; its {stream.topic} stays public")

    def _open_successors(self, stream: Stream) -> Iterator[EnforcementGap]:
        for successor in stream.successors:
            nodes = self._launched(successor)
            if not nodes:
                why = f"this launch does not start it{self._unread()}"
                rest = f"it hears the public {stream.topic}, where anyone can speak"
                yield EnforcementGap(what=successor, why=f"{why}; {rest}")
            elif not self._reached(nodes, stream):
                yield self._remapped_elsewhere(successor, stream)

    def _open_publishers(self, stream: Stream) -> Iterator[EnforcementGap]:
        for publisher in _launched_publishers(stream):
            nodes = self._launched(publisher)
            if not nodes and self.tree.unresolved:
                why = f"this launch is not seen to start it{self._unread()}"
                rest = f"what it publishes on {stream.topic} will count as unapproved"
                yield EnforcementGap(what=publisher, why=f"{why}; {rest}")
            elif nodes and not self._reached(nodes, stream):
                yield self._remapped_elsewhere(publisher, stream)

    def _inside_managers(self, stream: Stream) -> Iterator[EnforcementGap]:
        for manager, loaded in loaders(self.tree.nodes()).items():
            inside = [node for node in loaded if _has_both_roles(node, stream)]
            if len(inside) > 1:
                names = ", ".join(node.name for node in inside)
                why = f"its nodelets ({names}) hand {stream.topic} to each other inside the process"
                help = "name the loaders in the plan instead of the manager"
                yield EnforcementGap(what=manager, why=f"{why}; {help}")

    def _anonymous_spellings(self) -> Iterator[EnforcementGap]:
        for placed in (remap for remaps in self.remaps.values() for remap in remaps):
            if not placed.is_placeable:
                why = f"its remap of {placed.written} to {placed.target} has an anonymous name"
                yield EnforcementGap(what=placed.node, why=why)

    def _absent_publishers(self, stream: Stream) -> Iterator[str]:
        for publisher in _launched_publishers(stream):
            if not self._launched(publisher) and not self.tree.unresolved:
                absent = f"{publisher} is not started by this launch"
                yield f"{absent}: what it publishes on {stream.topic} will count as unapproved"

    def _self_delivery(self, stream: Stream) -> Iterator[str]:
        for node in self.tree.nodes():
            if _has_both_roles(node, stream) and not manager_of(node):
                subject = f"{node.name} publishes and subscribes {stream.topic}"
                yield f"{subject}: what it delivers to itself is not guarded"

    def _unnamed_readers(self, stream: Stream) -> Iterator[str]:
        if not stream.successors:
            subject = f"the plan names no successor of {stream.topic}: readers keep the public name"
            yield f"{subject}, where the guard publishes and anyone else can; name it to close that"

    def _named_loaders(self, stream: Stream) -> Iterator[str]:
        for node in self.tree.nodes():
            manager = manager_of(node)
            named = (*stream.successors, *(flow.publisher for flow in stream.flows))
            if manager and any(matches_node(name, node.name) for name in named):
                yield f"{node.name} is a nodelet: at run time {stream.topic} is {manager}'s"

    def _launched(self, name: str) -> list[LaunchNode]:
        """Return the launched nodes that a name of the plan means, a manager's loaders included."""
        nodes = self.tree.nodes()
        return [node for node in nodes if any(matches_node(name, n) for n in _names(node))]

    def _reached(self, nodes: list[LaunchNode], stream: Stream) -> bool:
        """Tell whether a remap closes the topic at one of the nodes, or one is lost anyway."""
        if any(node in self.unreachable for node in nodes):
            return True
        placed = (remap for node in nodes for remap in self.remaps.get(node, ()))
        names = public_names(stream)
        return any(remap.topic in names for remap in placed)

    def _unread(self) -> str:
        unread = ", ".join(unresolved.what for unresolved in self.tree.unresolved)
        return f", unless from what could not be read ({unread})" if unread else ""

    def _remapped_elsewhere(self, name: str, stream: Stream) -> EnforcementGap:
        why = f"its own remap takes {stream.topic} elsewhere, and none leads to it"
        return EnforcementGap(what=name, why=why)


def _names(node: LaunchNode) -> list[str]:
    return [name for name in (node.name, manager_of(node)) if name]


def _has_both_roles(node: LaunchNode, stream: Stream) -> bool:
    role = stream_role(node, stream)
    return bool(role and role.flow and role.is_successor)


def _launched_publishers(stream: Stream) -> list[str]:
    """Return who publishes a stream, but for the clients of a bridge, which no launch starts."""
    return [each.publisher for each in stream.flows if not is_bridge_client(each.publisher)]
