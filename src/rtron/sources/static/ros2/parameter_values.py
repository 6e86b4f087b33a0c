"""What a launch, or a parameter file, sets for a node of ROS 2."""

from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import NodeSite, ParameterSetting
from rtron.sources.launch.ros2.parameters.file import entries_of, tree_of
from rtron.sources.launch.ros2.parameters.merge import names
from rtron.vocabulary import ParameterValue


def given_value(site: NodeSite, node: str, parameter: str) -> ParameterValue | None:
    """Return a parameter's value, the last that fits the node's full name; None for none."""
    is_own = node == site.name
    settings = site.own_settings if is_own else site.settings
    found = [s.value for s in settings if s.name == parameter and names(s.node, node)]
    if is_own:
        found += [value for name, value in site.overrides if name == parameter]
    return found[-1] if found else None


def settings_of(path: str, files: WorkspaceFiles) -> Iterator[ParameterSetting]:
    """Yield what a parameter file sets; raise InputError where it cannot be read."""
    text = files.text(Path(path))
    if text is None:
        raise InputError("is not in the folders that are read", path=path)
    for node, values in entries_of(tree_of(text, path), path):
        for name, found in values.items():
            yield ParameterSetting(node=node, name=name, value=found.value)
