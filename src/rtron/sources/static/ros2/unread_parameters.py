"""Parameters that a launch sets and that the node, whose source was read, does not declare."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from difflib import get_close_matches

from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import UNREAD_PARAMETER, UnresolvedItem
from rtron.vocabulary.parameters import pattern_matches

_OF_EVERY_NODE = ("use_sim_time", "qos_overrides.", "start_type_description_service")
"""What the client libraries declare or read by themselves."""
_NEAR_RATIO = 0.8


def unread_parameters(parts: Iterable[NodePart]) -> Iterator[UnresolvedItem]:
    """Yield a note for each set parameter without effect, with a near name that is not set.

    A node counts if its source was read whole and declares parameters, all with known names. A parameter that stands for
    all nodes (`/**`) counts if no node of the app declares it.
    """
    read = [part for part in parts if part.task and not part.interface.unresolved]
    declared: dict[str, set[str]] = defaultdict(set)
    for part in read:
        for each in part.interface.parameters:
            declared[each.node].add(each.name)
    everywhere = set().union(*declared.values())
    for part in read:
        for node in _nodes_with_parameters(part):
            set_by_launch = _set_by_launch(part, node)
            for name in _unread(set_by_launch, declared[node], everywhere):
                yield _note(part, node, name, declared[node] - set_by_launch.keys())


def _nodes_with_parameters(part: NodePart) -> list[str]:
    """Return the nodes with parameters of their own, and none whose name is not known."""
    own = [p for p in part.interface.parameters if not p.name.startswith(_OF_EVERY_NODE)]
    open_nodes = {parameter.node for parameter in own if "{" in parameter.name}
    return [node for node in dict.fromkeys(p.node for p in own) if node not in open_nodes]


def _set_by_launch(part: NodePart, node: str) -> dict[str, bool]:
    """Return the parameters that a launch sets for a node, and whether for this one alone."""
    site = part.node.site
    fitting = (each for each in site.node_settings if pattern_matches(each.node, node))
    found = {each.name: "*" not in each.node for each in fitting}
    return found | {name: True for name, _ in site.overrides}


def _unread(
    set_by_launch: Mapping[str, bool], declared: set[str], everywhere: set[str]
) -> Iterator[str]:
    for name, is_for_node in set_by_launch.items():
        is_read = name in declared or not (is_for_node or name not in everywhere)
        is_below = any(each.startswith(f"{name}.") for each in declared)
        if not (is_read or is_below or name.startswith(_OF_EVERY_NODE)):
            yield name


def _note(part: NodePart, node: str, name: str, unset: set[str]) -> UnresolvedItem:
    near = get_close_matches(name, sorted(unset), 1, _NEAR_RATIO)
    why = f"{UNREAD_PARAMETER}; it declares {near[0]}" if near else UNREAD_PARAMETER
    return UnresolvedItem(
        what=f"parameter {name} of {node}", why=why, evidence=(part.node.evidence,)
    )
