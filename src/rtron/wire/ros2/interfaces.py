"""The message, service and action types that are installed here: classes, texts and hashes.

What is installed, the ament resource index tells: `share/ament_index/resource_index/
rosidl_interfaces/<package>` lists a package's interfaces, `share/<package>` holds them. Type names
come from strangers: only what the index lists by exactly that name is read or imported.
"""

from __future__ import annotations

import json
import os
import re
import sysconfig
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path

from rtron.errors import InputError, SourceError
from rtron.messages.definition import PRIMITIVES
from rtron.messages.definition_lines import sections
from rtron.messages.definition_text import MAX_TEXT, parse_definition

MAX_DESCRIPTION = 1 << 22
"""The longest type description that is read for its hash, bytes."""
_INDEX = Path("share/ament_index/resource_index/rosidl_interfaces")
_TYPE = re.compile(
    r"(?P<package>[a-z][a-z0-9_]{0,127})/(?:(?P<kind>msg|srv|action)/)?(?P<name>[A-Z][A-Za-z0-9]{0,127})",
    re.ASCII,
)
_LONGEST_NAME = 300
_MOST_TYPES = 256
_RULE = "=" * 80


@dataclass(frozen=True, slots=True, kw_only=True)
class Interface:
    """A type that is installed here.

    `type` is in ROS 2's spelling (`pkg/msg/Name`), `name` in ours (`pkg/Name`; of an action, its
    goal's, `pkg/Name_Goal`, of a service its request's). `definition` is the text of `name` with
    those of all types in it, `md5sum` its ROS 1 sum, `type_hash` the REP 2016 hash of `type`, ""
    before ROS 2 Iron. `cls` is what rclpy makes endpoints from.
    """

    cls: type
    type: str
    name: str
    definition: str
    md5sum: str
    type_hash: str


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a type is installed; `kind` is msg, srv or action."""

    package: str
    kind: str
    name: str
    prefix: Path

    @property
    def type(self) -> str:
        return f"{self.package}/{self.kind}/{self.name}"

    def file(self, ending: str) -> Path:
        return self.prefix / "share" / self.package / self.kind / f"{self.name}.{ending}"


@lru_cache(maxsize=_MOST_TYPES)
def interface(type: str) -> Interface:
    """Return an installed type, asked for in either ROS's spelling.

    SourceError, whose help names the package, if it is not installed or cannot be read.
    """
    place = _place(type)
    suffix = {"msg": "", "srv": "_Request", "action": "_Goal"}[place.kind]
    name = f"{place.package}/{place.name}{suffix}"
    text = _whole_text(name, place)
    try:
        md5sum = parse_definition(name, text).md5sum
    except InputError as error:
        raise SourceError(f"the definition of {place.type}: {error}", help=error.help) from error
    return Interface(
        cls=_class(place),
        type=place.type,
        name=name,
        definition=text,
        md5sum=md5sum,
        type_hash=_type_hash(place),
    )


def _place(type: str) -> _Place:
    """Return where a type is installed, if the index lists it."""
    parts = _TYPE.fullmatch(type) if len(type) <= _LONGEST_NAME else None
    if parts is None:
        raise SourceError(f"{type[:80]!r} is not a type of ROS 2", help="it is pkg/msg/Name")
    package, kind, name = parts["package"], parts["kind"] or "msg", parts["name"]
    for prefix in _prefixes():
        listed = _listed(prefix / _INDEX / package)
        if listed is not None:
            if listed & {f"{kind}/{name}.{kind}", f"{kind}/{name}.idl"}:
                return _Place(package, kind, name, prefix)
            break
    raise SourceError(
        f"{package}/{kind}/{name} is not installed here",
        help=f"install the package {package}, or source the workspace that has it",
    )


def _prefixes() -> list[Path]:
    """Return where packages are installed: what was sourced, then wheels beside this Python."""
    sourced = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(each) for each in (*sourced, sysconfig.get_path("data")) if each]


def _listed(resource: Path) -> frozenset[str] | None:
    try:
        return frozenset(_read(resource, MAX_DESCRIPTION).splitlines())
    except OSError:
        return None


def _read(path: Path, most: int) -> str:
    """Return a file's text; OSError also if it is longer than `most` bytes."""
    with path.open("rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(f"{path} is longer than {most} bytes")
    return data.decode(errors="replace")


def _whole_text(name: str, place: _Place) -> str:
    """Return the text of a type with those of all types in it, each once."""
    texts = {name: _first_part(place)}
    wanted = _types_in(name, texts[name])
    while wanted:
        each = wanted.pop()
        if each not in texts:
            texts[each] = _first_part(_place(each))
            wanted += _types_in(each, texts[each])
        if sum(map(len, texts.values())) > MAX_TEXT:
            raise SourceError(f"{place.type}: its definition exceeds {MAX_TEXT} characters")
    own = texts.pop(name)
    return own + "".join(f"\n{_RULE}\nMSG: {each}\n{text}" for each, text in texts.items())


def _first_part(place: _Place) -> str:
    """Return a message, a service's request or an action's goal as its file defines it."""
    path = place.file(place.kind)
    try:
        lines = _read(path, MAX_TEXT).splitlines()
    except OSError as error:
        raise SourceError(
            f"no definition of {place.type} can be read: {error}",
            help=f"reinstall the package {place.package}",
        ) from error
    return "\n".join(lines[: lines.index("---")] if "---" in lines else lines)


def _types_in(name: str, text: str) -> list[str]:
    try:
        fields = sections(name, text)[name].fields
    except InputError as error:
        raise SourceError(f"the definition of {name}: {error}", help=error.help) from error
    return [each.type for each in fields if each.type not in PRIMITIVES]


def _class(place: _Place) -> type:
    try:
        found = getattr(import_module(f"{place.package}.{place.kind}"), place.name)
    except (ImportError, AttributeError) as error:
        raise SourceError(
            f"{place.type} is listed, but Python cannot import it: {error}",
            help=f"source the workspace that has {place.package}",
        ) from error
    if not isinstance(found, type):
        raise SourceError(f"{place.type} is no class")
    return found


def _type_hash(place: _Place) -> str:
    """Return what the installed description says; distributions before Iron have none."""
    try:
        told = json.loads(_read(place.file("json"), MAX_DESCRIPTION))
        hashes = {each["type_name"]: each["hash_string"] for each in told["type_hashes"]}
        return str(hashes.get(place.type, ""))
    except (OSError, ValueError, LookupError, TypeError):
        return ""
