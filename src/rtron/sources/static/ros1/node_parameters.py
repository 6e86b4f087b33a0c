"""What of the parameter server belongs to one node: what stands below its name."""

from collections.abc import Collection, Iterator

from rtron.vocabulary import NodeParameter, NodeParameterValue, ParameterTree, ParameterValue

_OF_CONTROLLERS = "cmd_vel_timeout"
"""Controllers of ros_control are no nodes, their parameters stand below their own names."""


def node_parameters(parameters: ParameterTree, nodes: Collection[str]) -> Iterator[NodeParameter]:
    """Yield the parameters of nodes, as `group.name`, and the timeouts of controllers."""
    for full_name, leaf in parameters.leaves.items():
        owner = next(filter(nodes.__contains__, _namespaces(full_name)), "")
        if not owner and full_name.endswith(f"/{_OF_CONTROLLERS}"):
            owner = full_name.rpartition("/")[0]
        if owner:
            name = full_name.removeprefix(f"{owner}/").replace("/", ".")
            yield NodeParameter(node=owner, name=name, value=_plain(leaf.value))


def _namespaces(name: str) -> Iterator[str]:
    """Yield what a name lies in, the nearest first."""
    while name := name.rpartition("/")[0]:
        yield name


def _plain(value: ParameterValue) -> NodeParameterValue | None:
    """Return a value that a node of ROS 2 may have too, None for another."""
    if isinstance(value, list):
        items = tuple(item for item in value if isinstance(item, (bool, int, float, str)))
        return items if len(items) == len(value) else None
    return value if isinstance(value, (bool, int, float, str)) else None
