"""The commands of ament: components, plugins, targets of all files in a folder (docs.ros.org)."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from rtron.sources.workspace.cmake.command_call import CommandCall, split_by_keyword
from rtron.sources.workspace.cmake.targets import add_target
from rtron.sources.workspace.cmake.values import ExpandedArgument
from rtron.sources.workspace.cmake.variables import Handler
from rtron.sources.workspace.package_contents import ComponentClass, TargetKind

_WORDS = frozenset({"PLUGIN", "EXECUTABLE", "EXECUTOR", "RESOURCE_INDEX", "NODE_PREFIX"})
_COMPILED = ("*.c", "*.cc", "*.cpp", "*.cxx")


def register_components(call: CommandCall) -> None:
    """Carry out `rclcpp_components_register_nodes(target class …)`."""
    _note_unknown_class(call)
    found = split_by_keyword(call.words, _WORDS)[""]
    for cls in found[1:]:
        _add_component(call, found[0], cls, "")


def register_component(call: CommandCall) -> None:
    """Carry out `rclcpp_components_register_node(target PLUGIN class EXECUTABLE name)`."""
    _note_unknown_class(call)
    found = split_by_keyword(call.words, _WORDS)
    executable = next(iter(found.get("EXECUTABLE", [])), "")
    for target, cls in zip(found[""][:1], found.get("PLUGIN", [])[:1], strict=False):
        _add_component(call, target, cls, executable)


def _note_unknown_class(call: CommandCall) -> None:
    if not all(item.known for item in call.items):
        what = f"{call.name}({' '.join(call.words)[:80]})"
        call.add_unresolved(what, "some of it is not set in the file")


def _add_component(call: CommandCall, target: str, cls: str, executable: str) -> None:
    made = ComponentClass(class_name=cls.removeprefix("::"), library=target, executable=executable)
    for name in filter(None, (made.class_name, executable)):
        call.build.note_left_out(name)
    call.build.components[made.class_name, executable] = made


def export_plugins(call: CommandCall) -> None:
    """Carry out `pluginlib_export_plugin_description_file(package file)`."""
    words = call.words
    if len(words) > 1:
        call.build.exports[words[0], call.scope.folder / words[1]] = None


def link_packages(call: CommandCall) -> None:
    """Carry out `ament_target_dependencies(target package …)`."""
    words = call.words
    draft = call.build.targets.get(words[0]) if words else None
    if draft is not None:
        names = (word for word in words[1:] if word not in {"PUBLIC", "INTERFACE", "SYSTEM"})
        draft.links.update(dict.fromkeys(names))


def add_auto_target(kind: TargetKind, call: CommandCall) -> None:
    """Carry out `ament_auto_add_library` or `…_executable`, with all files below a DIRECTORY.

    Either links the libraries of its package that stand before it (ament_cmake_auto).
    """
    libraries = [d.name for d in call.build.targets.values() if d.kind is TargetKind.LIBRARY]
    add_target(kind, replace(call, items=tuple(_expand_directories(call))))
    draft = call.build.targets.get(call.words[0]) if call.words else None
    if draft is not None:
        draft.links.update(dict.fromkeys(libraries))


def _expand_directories(call: CommandCall) -> Iterator[ExpandedArgument]:
    items = list(call.items)
    while items:
        item = items.pop(0)
        if item.text == "DIRECTORY" and items:
            folder = call.scope.folder / items.pop(0).text
            found = (
                call.build.files.glob(f"{folder}/{p}", recursive=True, with_folders=False)
                for p in _COMPILED
            )
            yield from (replace(item, text=str(path)) for paths in found for path in paths)
        elif item.text != "NO_TARGET_LINK_LIBRARIES":
            yield item


AMENT_COMMANDS: Mapping[str, Handler] = {
    "rclcpp_components_register_nodes": register_components,
    "rclcpp_components_register_node": register_component,
    "pluginlib_export_plugin_description_file": export_plugins,
    "ament_target_dependencies": link_packages,
    "ament_auto_add_library": partial(add_auto_target, TargetKind.LIBRARY),
    "ament_auto_add_executable": partial(add_auto_target, TargetKind.EXECUTABLE),
}
