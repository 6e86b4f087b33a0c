"""YAML files that a controller spawner is given in place of names (ros_control's spawner)."""

from dataclasses import replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.declaration import NodeSite
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain_value
from rtron.sources.workspace.package_files import is_regular
from rtron.vocabulary import Evidence, Parameter, ParameterTree
from rtron.vocabulary.launch import canonical_name

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
