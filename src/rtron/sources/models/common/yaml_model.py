"""A model's YAML file, read safely and checked; every fault names the file and the line."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache, cached_property
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from rtron.errors import InputError, plain_reason
from rtron.sources.bounded_file import read_bounded
from rtron.sources.models.common.schema import MODEL_KINDS, Model
from rtron.yaml_safety import SAFE_LOADER, YamlRules, yaml_errors
from rtron.yaml_safety import compose_yaml as safe_tree

T = TypeVar("T", bound=BaseModel)

MAX_BYTES = 2**20
_YAML_RULES = YamlRules(max_depth=20)
_MAX_SHOWN = 60


def read_model(path: Path, schema: type[T]) -> T:
    """Return a YAML file as `schema`; raise InputError with its line where it is wrong."""
    root = compose_yaml(path)
    try:
        return schema.model_validate(construct_value(root, path))
    except ValidationError as error:
        raise _model_error(error, root, path, schema) from None


def compose_yaml(path: Path) -> yaml.Node:
    """Return the tree of a YAML file; raise InputError if it is none, too large or too deep."""
    root = safe_tree(read_bounded(path, MAX_BYTES), str(path), _YAML_RULES)
    if root is None:
        raise InputError("the file is empty", path=str(path))
    return root


def construct_value(root: yaml.Node, path: Path) -> Any:  # noqa: ANN401 - any YAML value
    """Return the values of a YAML tree; raise InputError if one cannot be made."""
    loader = SAFE_LOADER("")
    try:
        with yaml_errors(str(path)):
            return loader.construct_document(root)
    finally:
        loader.dispose()


def _model_error(
    error: ValidationError, root: yaml.Node, path: Path, schema: type[T]
) -> InputError:
    details = error.errors(include_url=False)[0]
    path_keys = [part for part in details["loc"] if part != "[key]"]
    line = _line(root, path_keys)
    dotted_path = ".".join(str(part) for part in path_keys)
    message = f"{dotted_path}: {plain_reason(details['msg'])}"[:200]
    return InputError(message, path=str(path), line=line, help=_help(path_keys, schema))


def _line(node: yaml.Node, path_keys: list[Any]) -> int:
    line = int(node.start_mark.line) + 1
    for part in path_keys:
        step = _child_node(node, part)
        if step is None:
            return line
        line, node = step
    return line


def _child_node(node: yaml.Node, part: object) -> tuple[int, yaml.Node] | None:
    if isinstance(node, yaml.SequenceNode) and isinstance(part, int):
        return int(node.value[part].start_mark.line) + 1, node.value[part]
    if not isinstance(node, yaml.MappingNode):
        return None
    matches = ((key, value) for key, value in node.value if key.value == part)
    return next(((int(key.start_mark.line) + 1, value) for key, value in matches), None)


def _help(path_keys: list[Any], schema: type[BaseModel]) -> str:
    known = schema.model_json_schema()
    keys = [*known.get("properties", {})]
    for definition in known.get("$defs", {}).values():
        keys += definition.get("properties", {})
    matches = get_close_matches(str(path_keys[-1] if path_keys else "")[:_MAX_SHOWN], keys, n=1)
    return (
        f"did you mean {matches[0]}?"
        if matches and matches[0] not in path_keys
        else "see docs/models.md"
    )


_MODELS = Path(__file__).parents[1]
ROS1_LIBRARY = _MODELS / "ros1" / "library"
ROS2_LIBRARY = _MODELS / "ros2" / "library"


@dataclass(frozen=True, kw_only=True)
class ModelCatalog:
    """Models by kind and name (`("node", "amcl/amcl")`)."""

    by_name: Mapping[tuple[str, str], Model] = field(default_factory=dict)

    @cached_property
    def own_names(self) -> frozenset[str]:
        """What programs call themselves where no launch gives them a name (ROS 2)."""
        return frozenset(model.name for model in self.by_name.values() if model.name)

    def node(self, package: str, executable: str) -> Model | None:
        """Return the model of a node type, None if there is none."""
        return self.by_name.get(("node", f"{package}/{executable}"))

    def nodelet(self, class_name: str) -> Model | None:
        """Return the model of a nodelet class, `package/Class`."""
        return self.by_name.get(("nodelet", class_name))

    def component(self, class_name: str) -> Model | None:
        """Return the model of a component's class, `package::Class` (ROS 2)."""
        return self.by_name.get(("component", class_name))

    def gazebo_plugin(self, filename: str) -> Model | None:
        """Return the model of a Gazebo plugin, with or without folder, `lib` and `.so`."""
        return self.by_name.get(("gazebo_plugin", plugin_name(filename)))

    def controller(self, type: str) -> Model | None:
        """Return the model of a ros_control controller type."""
        return self.by_name.get(("controller", type))

    def hardware(self, plugin: str) -> Model | None:
        """Return the model of a hardware component of ros2_control."""
        return self.by_name.get(("hardware", plugin))

    def find(self, name: str) -> Model | None:
        """Return a model by `kind:name`, or a part by its name."""
        kind, colon, rest = name.partition(":")
        if colon and kind in MODEL_KINDS:
            return self.by_name.get((kind, rest))
        return self.by_name.get(("part", name))


def plugin_name(filename: str) -> str:
    """Return a Gazebo plugin's file name without folder, `lib` and `.so`."""
    return PurePosixPath(filename.strip()).name.removeprefix("lib").removesuffix(".so")


@cache
def load_models(folder: Path = ROS1_LIBRARY) -> ModelCatalog:
    """Return the models below a folder; raise InputError with file and line where one is wrong."""
    paths = sorted(folder.rglob("*.yaml"))
    return ModelCatalog(by_name=_by_name((path, read_model(path, Model)) for path in paths))


def _by_name(models: Iterable[tuple[Path, Model]]) -> dict[tuple[str, str], Model]:
    by_name: dict[tuple[str, str], Model] = {}
    for path, model in models:
        for kind in MODEL_KINDS:
            for name in getattr(model, kind):
                key = (kind, plugin_name(name) if kind == "gazebo_plugin" else name)
                if key in by_name:
                    raise InputError(f"{kind} {name} has another model", path=str(path))
                by_name[key] = model
    return by_name
