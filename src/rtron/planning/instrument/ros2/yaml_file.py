"""A YAML launch file of ROS 2, to be changed: by its text, so that comments stay."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import yaml

from rtron.errors import InputError
from rtron.planning.instrument.ros2.launch_file import (
    PREFIX,
    GuardedFolder,
    GuardStart,
    RemapPair,
    prepend_remaps,
)

YamlNode: TypeAlias = Any

_LOG_NAME = "exec_name"
_PLAIN = re.compile(r"[\w./+@~-]*")
_DIRNAME = re.compile(r"\$\( *(dirname|filename) *\)")


def yaml_file(path: str, folder: str) -> "YamlFile":
    """Read a file so that a copy elsewhere still means `folder` by `$(dirname)`.

    Raise InputError if it cannot be read or is not YAML. It was read before, within its bounds.
    """
    try:
        text = Path(path).read_bytes().decode()
        root: Any = yaml.compose(text, Loader=yaml.SafeLoader)
    except (OSError, UnicodeError, yaml.YAMLError) as error:
        raise InputError(f"cannot be read: {error}", path=path) from None
    file = YamlFile(path=path, text=text, root=root, bodies=dict(_bodies(root)))
    for match in _DIRNAME.finditer(text):
        if not _PLAIN.fullmatch(path):
            raise InputError("lies in a folder whose name cannot stand in a launch file", path=path)
        file.change(*match.span(), folder if match[1] == "dirname" else path)
    return file


def _bodies(node: YamlNode) -> Iterator[tuple[int, YamlNode]]:
    """Yield what stands behind each key, by where it begins."""
    if isinstance(node, yaml.MappingNode):
        for _, value in node.value:
            yield value.start_mark.index, value
            yield from _bodies(value)
    elif isinstance(node, yaml.SequenceNode):
        for item in node.value:
            yield item.start_mark.index, item
            yield from _bodies(item)


@dataclass(slots=True, kw_only=True)
class YamlFile:
    """See LaunchFileText; a place is where the value of an action begins, in characters."""

    path: str
    text: str
    root: YamlNode
    bodies: dict[int, YamlNode]
    _changes: list[tuple[int, int, str]] = field(default_factory=list)

    def add_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put entries first into `remap:`, or `remap:` first into a node."""
        remap = self._entry(index, "remap")
        if isinstance(remap, yaml.SequenceNode):
            self._insert_items(remap, [{"from": a, "to": b} for a, b in rules])
        else:
            self._insert_key(index, "remap", [{"from": a, "to": b} for a, b in rules])

    def add_early_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put remaps into a node's `args:`."""
        args = self._entry(index, "args")
        if args is None:
            self._insert_key(index, "args", prepend_remaps(rules, ""))
        else:
            self._replace(args, prepend_remaps(rules, str(args.value)))

    def is_component(self, index: int) -> bool:
        """Tell whether it is an entry of `composable_node:`."""
        return self._entry(index, "plugin") is not None

    def start_through(self, index: int, prefix: str, name: str) -> None:
        """Put a prefix into `launch-prefix:`, and a name into `exec_name:` if there is none."""
        if self.is_component(index):
            return
        own = self._entry(index, PREFIX)
        if own is None:
            self._insert_key(index, PREFIX, prefix)
        else:
            self._replace(own, f"{prefix} {own.value}")
        if self._entry(index, _LOG_NAME) is None:
            self._insert_key(index, _LOG_NAME, name)

    def redirect_include(self, index: int, file: str) -> None:
        """Change an include's `file:`."""
        written = self._entry(index, "file")
        if written is not None:
            self._replace(written, file)

    def add_guard(self, folder: GuardedFolder, guard: GuardStart) -> None:
        """Put variables, `let:`, `include:` and `executable:` first into the list of actions."""
        actions = self.root.value[0][1]
        if isinstance(actions, yaml.MappingNode):
            actions = next(value for key, value in actions.value if key.value == "children")
        process = {
            "cmd": folder / guard.script,
            "name": guard.name,
            "output": "screen",
            "respawn": "true",
        }
        prefix = {"name": PREFIX, "value": folder / guard.prefix}
        entries = [
            *({"set_env": {"name": n, "value": v}} for n, v in guard.environment.items()),
            {"let": {"name": folder.variable, "value": folder.folder}},
            {"include": {"file": folder / guard.check}},
            {"executable": process},
            *([{"let": prefix}] if guard.prefix else []),
        ]
        self._insert_items(actions, entries)

    def render(self) -> str:
        """Return the text with all changes made; one inside another is part of it."""
        pieces, last = [], 0
        for start, end, new in sorted(self._changes, key=lambda change: (change[0], -change[1])):
            if start >= last:
                pieces += [self.text[last:start], new]
                last = end
        return "".join([*pieces, self.text[last:]])

    def change(self, start: int, end: int, new: str) -> None:
        """Put other text from `start` to `end`."""
        self._changes.append((start, end, new))

    def _entry(self, index: int, key: str) -> YamlNode:
        body = self.bodies.get(index)
        if body is None:
            raise InputError("has changed since it was read", path=self.path, help="start again")
        entries = body.value if isinstance(body, yaml.MappingNode) else []
        return {name.value: value for name, value in entries}.get(key)

    def _insert_key(self, index: int, key: str, value: object) -> None:
        """Put a key first into a mapping, its value written as JSON, which is YAML."""
        body = self.bodies[index]
        written = f"{json.dumps(key)}: {json.dumps(value)}"
        end = ", " if body.flow_style else "\n" + " " * body.start_mark.column
        at = index + 1 if body.flow_style else index
        self.change(at, at, f"{written}{end}")

    def _insert_items(self, items: YamlNode, new: Sequence[object]) -> None:
        index = items.start_mark.index
        if items.flow_style:
            written = "".join(f"{json.dumps(item)}, " for item in new)
            self.change(index + 1, index + 1, written)
        else:
            indentation = " " * items.start_mark.column
            written = "".join(f"- {json.dumps(item)}\n{indentation}" for item in new)
            self.change(index, index, written)

    def _replace(self, scalar: YamlNode, new: str) -> None:
        self.change(scalar.start_mark.index, scalar.end_mark.index, json.dumps(new))
