"""What a launch, or a parameter file, sets for a node of ROS 2."""

from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite, ParameterSetting
from rtron.sources.launch.ros2.parameters.file import parameter_entries, parse_yaml_tree
from rtron.vocabulary import ParameterValue
from rtron.vocabulary.parameters import pattern_matches


def parameter_value(site: NodeSite, node: str, parameter: str) -> ParameterValue | None:
    """Return a parameter's value, the last that fits the node's full name; None for none."""
    is_own = node == site.name
    settings = site.node_settings if is_own else site.settings
    values = [s.value for s in settings if s.name == parameter and pattern_matches(s.node, node)]
    if is_own:
        values += [value for name, value in site.overrides if name == parameter]
    return values[-1] if values else None


def parameter_file_settings(path: str, files: WorkspaceSources) -> Iterator[ParameterSetting]:
    """Yield what a parameter file sets; raise InputError where it cannot be read."""
    text = files.read_text(Path(path))
    if text is None:
        raise InputError("is not in the folders that are read", path=path)
    for node, values in parameter_entries(parse_yaml_tree(text, path), path):
        for name, parameter in values.items():
            yield ParameterSetting(node=node, name=name, value=parameter.value)
