"""What a launch sets for a node of ROS 2."""

from rtron.sources.declaration import NodeSite
from rtron.sources.launch2.parameters import names
from rtron.vocabulary import ParameterValue


def given_value(site: NodeSite, node: str, parameter: str) -> ParameterValue | None:
    """Return a parameter's value, the last that fits the node's full name; None for none."""
    is_own = node == site.name
    settings = site.own_settings if is_own else site.settings
    found = [s.value for s in settings if s.name == parameter and names(s.node, node)]
    if is_own:
        found += [value for name, value in site.overrides if name == parameter]
    return found[-1] if found else None
