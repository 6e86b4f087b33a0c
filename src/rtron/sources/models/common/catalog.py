"""The library of models, looked up by what they stand for."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path, PurePosixPath

from rtron.errors import InputError
from rtron.sources.models.common.schema import MODEL_KINDS, Model
from rtron.sources.models.common.yaml_model import read_model

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
