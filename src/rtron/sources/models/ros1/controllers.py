"""What ros_control's controllers add to the node that hosts their manager.

ROS wiki: controller_manager; a controller's type stands at `NAMESPACE/NAME/type`.
"""

from dataclasses import replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain_value
from rtron.sources.models.common.arguments import option, positional
from rtron.sources.models.common.evaluation import handle_plugin_interface
from rtron.sources.models.common.values import has_placeholder, with_placeholders
from rtron.sources.models.common.yaml_model import ModelCatalog, load_models
from rtron.sources.workspace.package_files import is_regular
from rtron.vocabulary import Evidence, Parameter, ParameterTree, UnresolvedItem
from rtron.vocabulary.launch import canonical_name

_VALUED = "--namespace -n --timeout --controller-manager"
_SPAWNER_COMMANDS = ("spawn", "load", "spawner")


def controller_interface(
    spawner: NodeSite, parameters: ParameterTree, models: ModelCatalog | None = None
) -> NodeInterface:
    """Return what the controllers that `spawner` loads declare.

    Their names are the spawner's arguments; they live below its `--namespace`, by default
    its own. `spawner.remaps` do not matter: give the host's to the caller.
    """
    namespace = option(spawner.args, "--namespace -n") or spawner.name.rpartition("/")[0]
    models = models or load_models()
    site = replace(spawner, parameters=parameters, args=())
    interfaces = [
        _controller(name, canonical_name(f"/{namespace}"), site, models)
        for name in _controller_names(spawner)
    ]
    return NodeInterface(
        declarations=tuple(d for one in interfaces for d in one.declarations),
        unresolved=tuple(u for one in interfaces for u in one.unresolved),
        frames=tuple(frame for one in interfaces for frame in one.frames),
    )


def _controller_names(spawner: NodeSite) -> list[str]:
    words = positional(spawner.args, _VALUED)
    return words[1:] if words and words[0] in _SPAWNER_COMMANDS else words


def _controller(name: str, namespace: str, site: NodeSite, models: ModelCatalog) -> NodeInterface:
    private_namespace = canonical_name(f"{namespace}/{name}")
    parameter = site.parameters.get(f"{private_namespace}/type")
    type = with_placeholders(parameter.value, f"{private_namespace}/type") if parameter else None
    model = models.controller(type) if isinstance(type, str) else None
    if model is None:
        return NodeInterface(
            unresolved=(UnresolvedItem(what=f"controller {private_namespace}", why=_why(type)),)
        )
    return handle_plugin_interface(
        model, site, namespace=namespace or "/", private=private_namespace, models=models
    )


def _why(type: object) -> str:
    if type is None:
        return "its parameter type is not set"
    return "its type is not known" if has_placeholder(type) else f"no model of {str(type)[:80]}"


MAX_BYTES = 8 * 1024 * 1024
_ENDINGS = (".yaml", ".yml")


def add_controller_files(spawner: NodeSite) -> NodeSite:
    """Return a spawner with the names that its files hold, and with their parameters set."""
    args: list[str] = []
    leaves = dict(spawner.parameters.leaves)
    parameters = ParameterTree(leaves=leaves)
    for word in spawner.args:
        controllers_of_file = _read_controllers(Path(word)) if word.endswith(_ENDINGS) else {}
        for name, value in controllers_of_file.items():
            full = canonical_name(f"{spawner.name.rpartition('/')[0]}/{name}")
            parameters.set(full, Parameter(value=value, evidence=Evidence(file=word)))
        args.extend(controllers_of_file or [word])
    return replace(spawner, args=tuple(args), parameters=parameters)


def _read_controllers(path: Path) -> dict[str, object]:
    if not path.is_absolute() or not is_regular(path):
        return {}
    try:
        text = read_regular_file(path, MAX_BYTES).decode("utf-8", "replace")
        documents = parse_yaml(text, str(path)).documents
        values = [plain_value(document) for document in documents if document is not None]
    except (InputError, ValueError):
        return {}
    return {str(k): v for value in values if isinstance(value, dict) for k, v in value.items()}
