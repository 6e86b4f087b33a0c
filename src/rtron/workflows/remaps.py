"""List the remaps that a plan asks for, without a launch file: for nodes that start in another way."""

from rtron.errors import InputError, suggestion
from rtron.planning.instrument.common.remaps import enforced_streams, planned_nodes, private_names
from rtron.vocabulary import Plan, matches_node


def list_remaps(plan: Plan, node: str = "") -> tuple[tuple[str, str, str], ...]:
    """Return (node, public name, private name), for all nodes of the plan, or for one.

    `node` may be a name that a pattern of the plan means. InputError if the plan has no such node.
    """
    enforced = enforced_streams(plan)
    planned = planned_nodes(enforced)
    if node and not any(matches_node(each, node) for each in planned):
        help = suggestion(node, planned) if planned else "no coordination node enforces"
        raise InputError(f"the plan has no node {node}", help=help)
    return tuple(
        (name, public, private)
        for name in ([node] if node else planned)
        for public, private in private_names(name, enforced).items()
    )
