"""What a launch of ROS 1 sets for nodes: the parameters of each, and those it does not read."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from math import isfinite

from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.topic_parameters import near_parameters, unread_parameter
from rtron.vocabulary import (
    NodeParameter,
    NodeParameterValue,
    ParameterTree,
    ParameterValue,
    WiringFact,
)

_OF_CONTROLLERS = "cmd_vel_timeout"
"""Controllers of ros_control are no nodes, their parameters stand below their own names."""
_RECONFIGURED = "/parameter_descriptions"
"""What dynamic_reconfigure's server publishes, which reads the parameters of a .cfg file."""


def node_parameters(parameters: ParameterTree, nodes: Collection[str]) -> Iterator[NodeParameter]:
    """Yield the parameters of nodes, as `group.name`, and the timeouts of controllers."""
    for full_name, leaf in parameters.leaves.items():
        owner = next(filter(nodes.__contains__, _namespaces(full_name)), "")
        if not owner and full_name.endswith(f"/{_OF_CONTROLLERS}"):
            owner = full_name.rpartition("/")[0]
        if owner:
            name = full_name.removeprefix(f"{owner}/").replace("/", ".")
            yield NodeParameter(node=owner, name=name, value=_plain(leaf.value))
            for key, value in _items(leaf.value):
                yield NodeParameter(node=owner, name=f"{name}.{key}", value=_plain(value))


def _items(value: ParameterValue) -> Iterator[tuple[str, ParameterValue]]:
    """Yield what stands in the maps of a list, as `NUMBER.KEY`: the inputs of a twist_mux."""
    for number, item in enumerate(value if isinstance(value, list) else ()):
        for key, inner in item.items() if isinstance(item, dict) else ():
            yield f"{number}.{key}", inner


def _namespaces(name: str) -> Iterator[str]:
    """Yield what a name lies in, the nearest first."""
    while name := name.rpartition("/")[0]:
        yield name


def _plain(value: ParameterValue) -> NodeParameterValue | None:
    """Return a value that a node of ROS 2 may have too, None for another."""
    if isinstance(value, list):
        items = [None if isinstance(item, list) else _plain(item) for item in value]
        found = tuple(item for item in items if isinstance(item, (bool, int, float, str)))
        return found if len(found) == len(value) else None
    is_endless = isinstance(value, float) and not isfinite(value)
    return value if isinstance(value, (bool, int, float, str)) and not is_endless else None


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
    set_for = _set_for(parts_by_node, parameters)
    for node, of_node in parts_by_node.items():
        own, given = _below(node, read[node]), set_for[node]
        if own and all(map(_is_read_whole, of_node)) and "{" not in "".join(read[node]):
            others = (name for name in given if not _is_read(f"{node}/{name}", read_by_any))
            unread = [name for name in others if name not in private]
            near = near_parameters(unread, own - given)
            for name in sorted(unread):
                place = parameters.leaves[f"{node}/{name}"].evidence
                yield unread_parameter(node, name, near.get(name), place)


def _set_for(nodes: Collection[str], parameters: ParameterTree) -> dict[str, set[str]]:
    """Return the names below each node that the launch sets."""
    found: dict[str, set[str]] = defaultdict(set)
    for leaf in parameters.leaves:
        for owner in filter(nodes.__contains__, _namespaces(leaf)):
            found[owner].add(leaf.removeprefix(f"{owner}/"))
    return found


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
