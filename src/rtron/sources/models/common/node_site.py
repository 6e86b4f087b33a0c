"""Where a modelled node of ROS 2 runs: its own name, and its own remap rules."""

import shlex
from dataclasses import replace

from rtron.sources.declaration import NodeSite
from rtron.sources.models.common.expressions import ModelExpressions
from rtron.sources.models.common.model_scope import node_scope
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import parse_remap_rules


def resolve_ros2_site(default_name: str, site: NodeSite) -> NodeSite:
    """Return a site with its own remap rules, and the node's own name if its launch gives none.

    The own name is a template, as a model has it.
    """
    site = replace(
        site, remaps=(*parse_remap_rules(shlex.join(site.args), in_ros_args=False), *site.remaps)
    )
    if not default_name or _has_launch_name(site):
        return site
    node_name = ModelExpressions(node_scope(site)).text(default_name)
    return replace(site, name=canonical_name(f"{site.name.rpartition('/')[0]}/{node_name}"))


def _has_launch_name(site: NodeSite) -> bool:
    """Tell whether a launch names a node: what it says of a component's process is not for it."""
    is_process = site.loading is None
    return (site.has_launch_name and is_process) or any(
        word.startswith("__node:=") for word in site.args
    )
