"""What ros_control's controllers add to the node that hosts their manager.

ROS wiki: controller_manager; a controller's type stands at `NAMESPACE/NAME/type`.
"""

from dataclasses import replace

from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.sources.models.common.arguments import option, positional
from rtron.sources.models.common.catalog import Models, load_models
from rtron.sources.models.common.evaluation import handle_interface
from rtron.sources.models.common.values import has_hole, known
from rtron.vocabulary import Parameters, Unresolved
from rtron.vocabulary.launch import canonical_name

_VALUED = "--namespace -n --timeout --controller-manager"
_LOADING = ("spawn", "load", "spawner")


def controllers(
    spawner: NodeSite, parameters: Parameters, namespace: str = "", models: Models | None = None
) -> NodeInterface:
    """Return what the controllers that `spawner` loads declare.

    Their names are the spawner's arguments; they live below `namespace`, by default the spawner's
    (or its `--namespace`). `spawner.remaps` do not matter: give the host's to the caller.
    """
    below = namespace or option(spawner.args, "--namespace -n") or spawner.name.rpartition("/")[0]
    models = models or load_models()
    site = replace(spawner, parameters=parameters, args=())
    found = [_one(name, canonical_name(f"/{below}"), site, models) for name in _names(spawner)]
    return NodeInterface(
        declarations=tuple(d for one in found for d in one.declarations),
        unresolved=tuple(u for one in found for u in one.unresolved),
    )


def _names(spawner: NodeSite) -> list[str]:
    words = positional(spawner.args, _VALUED)
    return words[1:] if words and words[0] in _LOADING else words


def _one(name: str, namespace: str, site: NodeSite, models: Models) -> NodeInterface:
    own = canonical_name(f"{namespace}/{name}")
    found = site.parameters.get(f"{own}/type")
    type = known(found.value, f"{own}/type") if found else None
    model = models.controller(type) if isinstance(type, str) else None
    if model is None:
        return NodeInterface(unresolved=(Unresolved(what=f"controller {own}", why=_why(type)),))
    return handle_interface(model, site, namespace=namespace or "/", private=own, models=models)


def _why(type: object) -> str:
    if type is None:
        return "its parameter type is not set"
    return "its type is not known" if has_hole(type) else f"no model of {str(type)[:80]}"
