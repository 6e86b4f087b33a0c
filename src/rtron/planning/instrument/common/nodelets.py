"""Which manager process runs each nodelet (ROS wiki: nodelet)."""

import shlex
from collections import defaultdict
from collections.abc import Iterable, Mapping

from rtron.vocabulary import LaunchNode
from rtron.vocabulary.launch import resolve_name


def manager_of(node: LaunchNode) -> str | None:
    """Return the manager that a node loads its nodelet into; None for every other node."""
    if (node.package, node.type) != ("nodelet", "nodelet"):
        return None
    match _words(node.args):
        case ["load", _, manager, *_]:
            return resolve_name(manager, node.name)
    return None


def loaders(nodes: Iterable[LaunchNode]) -> Mapping[str, list[LaunchNode]]:
    """Return the loaders of each manager."""
    by_manager: dict[str, list[LaunchNode]] = defaultdict(list)
    for node in nodes:
        manager = manager_of(node)
        if manager:
            by_manager[manager].append(node)
    return by_manager


def _words(args: str) -> list[str]:
    try:
        return shlex.split(args)
    except ValueError:
        return args.split()
