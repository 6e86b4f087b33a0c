"""Parameters that a launch of ROS 1 sets for a node whose source does not read them."""

from collections import defaultdict
from collections.abc import Iterable, Iterator

from rtron.sources.static.common.near_parameters import near_parameters, unread_parameter
from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import ParameterTree, WiringFact

_RECONFIGURED = "/parameter_descriptions"
"""What dynamic_reconfigure's server publishes, which reads the parameters of a .cfg file."""


def unread_parameters(parts: Iterable[NodePart], parameters: ParameterTree) -> Iterator[WiringFact]:
    """Yield a fact for each private parameter that its node does not read, with the near name.

    A near name is one that the node reads and nobody sets. A node counts if its source was read
    whole and reads private parameters, all with known names. A file is often given to several
    nodes: a parameter that another node reads of its own, or of this one, does not count.
    """
    parts_by_node: dict[str, list[NodePart]] = defaultdict(list)
    for part in parts:
        parts_by_node[part.node.name].append(part)
    read = {node: _read_names(of_node) for node, of_node in parts_by_node.items()}
    read_by_any = set().union(*read.values())
    private = set().union(*(_below(node, names) for node, names in read.items()))
    for node, of_node in parts_by_node.items():
        own = _below(node, read[node])
        if own and all(map(_is_read_whole, of_node)) and "{" not in "".join(read[node]):
            given = _below(node, parameters.leaves.keys())
            others = (name for name in given if not _is_read(f"{node}/{name}", read_by_any))
            unread = [name for name in others if name not in private]
            near = near_parameters(unread, own - given)
            for name in sorted(unread):
                place = parameters.leaves[f"{node}/{name}"].evidence
                yield unread_parameter(node, name, near.get(name), place)


def _read_names(parts: Iterable[NodePart]) -> set[str]:
    return {parameter.name for part in parts for parameter in part.interface.parameters}


def _is_read_whole(part: NodePart) -> bool:
    interface = part.interface
    is_reconfigured = any(each.name.endswith(_RECONFIGURED) for each in interface.declarations)
    return bool(part.task and not part.model and not interface.unresolved and not is_reconfigured)


def _below(node: str, names: Iterable[str]) -> set[str]:
    return {name.removeprefix(f"{node}/") for name in names if name.startswith(f"{node}/")}


def _is_read(name: str, read: set[str]) -> bool:
    """Return whether a parameter is read, or the group it is in, or one below it."""
    parts = name.split("/")
    groups = {"/".join(parts[:count]) for count in range(2, len(parts) + 1)}
    return not groups.isdisjoint(read)
