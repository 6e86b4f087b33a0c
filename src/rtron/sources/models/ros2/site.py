"""Where a modelled node of ROS 2 runs: its own name, and its own remap rules."""

import shlex
from dataclasses import replace

from rtron.sources.declaration import NodeSite
from rtron.sources.models.common.expressions import Expressions
from rtron.sources.models.common.model_scope import scope_at
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import rules_in


def ros2_site(own_name: str, site: NodeSite) -> NodeSite:
    """Return a site with its own remap rules, and the node's own name if its launch gives none.

    The own name is a template, as a model has it.
    """
    site = replace(site, remaps=(*rules_in(shlex.join(site.args), ros=False), *site.remaps))
    if not own_name or _is_named(site):
        return site
    own = Expressions(scope_at(site)).text(own_name)
    return replace(site, name=canonical_name(f"{site.name.rpartition('/')[0]}/{own}"))


def _is_named(site: NodeSite) -> bool:
    """Tell whether a launch names a node: what it says of a component's process is not for it."""
    is_process = site.loading is None
    return (site.named and is_process) or any(word.startswith("__node:=") for word in site.args)
