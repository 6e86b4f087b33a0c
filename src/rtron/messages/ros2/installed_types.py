"""The types of ROS 2 that are installed here, and their definitions.

What is installed, the ament resource index tells: `share/ament_index/resource_index/
rosidl_interfaces/<package>` lists a package's interfaces, `share/<package>` holds them. Type names
come from strangers: only what the index lists by exactly that name is read, and nothing of it runs.
"""

import os
import re
import sysconfig
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError, SourceError
from rtron.messages.common.definition import PRIMITIVES
from rtron.messages.common.definition_parser import MAX_TEXT, parse_sections

MAX_FILE_BYTES = 1 << 22
"""The longest file of the index, or description of a type, that is read, bytes."""
_INDEX = Path("share/ament_index/resource_index/rosidl_interfaces")
_TYPE = re.compile(
    r"(?P<package>[a-z][a-z0-9_]{0,127})/(?:(?P<kind>msg|srv|action)/)?(?P<name>[A-Z][A-Za-z0-9]{0,127})",
    re.ASCII,
)
_LONGEST_NAME = 300
_SUFFIX = {"msg": "", "srv": "_Request", "action": "_Goal"}
_RULE = "=" * 80


@dataclass(frozen=True, slots=True)
class InstalledType:
    """Where a type is installed; `kind` is msg, srv or action."""

    package: str
    kind: str
    name: str
    prefix: Path

    @property
    def type(self) -> str:
        """The type in ROS 2's spelling."""
        return f"{self.package}/{self.kind}/{self.name}"

    @property
    def definition_name(self) -> str:
        """The type that the definition is of, in our spelling; of an action its goal's."""
        return f"{self.package}/{self.name}{_SUFFIX[self.kind]}"

    def file(self, ending: str) -> Path:
        """Return the file of the type that has this ending."""
        return self.prefix / "share" / self.package / self.kind / f"{self.name}.{ending}"

    def definition(self) -> str:
        """Return the text of the type with those of all types in it, each once.

        SourceError if it cannot be read or is too long.
        """
        name = self.definition_name
        texts = {name: _first_part(self)}
        pending = _types_in(name, texts[name])
        while pending:
            each = pending.pop()
            if each not in texts:
                texts[each] = _first_part(get_installed_type(each))
                pending += _types_in(each, texts[each])
            if sum(map(len, texts.values())) > MAX_TEXT:
                raise SourceError(f"{self.type}: its definition exceeds {MAX_TEXT} characters")
        own = texts.pop(name)
        return own + "".join(f"\n{_RULE}\nMSG: {each}\n{text}" for each, text in texts.items())


def get_installed_type(type: str) -> InstalledType:
    """Return where a type is installed, asked for in either ROS's spelling.

    SourceError, whose help names the package, if the index does not list it.
    """
    installed = find_installed_type(type)
    if installed:
        return installed
    parts = _parts(type)
    if parts is None:
        raise SourceError(f"{type[:80]!r} is not a type of ROS 2", help="it is pkg/msg/Name")
    package = parts["package"]
    raise SourceError(
        f"{package}/{parts['kind'] or 'msg'}/{parts['name']} is not installed here",
        help=f"install the package {package}, or source the workspace that has it",
    )


def find_installed_type(type: str) -> InstalledType | None:
    """Return where a type is installed; None if it is not, or the name is none."""
    parts = _parts(type)
    if parts is None:
        return None
    package, kind, name = parts["package"], parts["kind"] or "msg", parts["name"]
    for prefix in install_prefixes():
        listed = _listed(prefix / _INDEX / package)
        if listed is not None:
            known = listed & {f"{kind}/{name}.{kind}", f"{kind}/{name}.idl"}
            return InstalledType(package, kind, name, prefix) if known else None
    return None


def find_interface_text(type: str, kind: str) -> str:
    """Return the text of a type, srv or action; SourceError if it is not installed."""
    package, _, name = type.partition("/")
    installed = get_installed_type(f"{package}/{kind}/{name}")
    try:
        return read_text(installed.file(kind), MAX_FILE_BYTES)
    except OSError as error:
        raise SourceError(f"no definition of {type} can be read: {error}") from error


def read_text(path: Path, max_bytes: int) -> str:
    """Return a file's text; OSError also if it is longer than `max_bytes` bytes."""
    with path.open("rb") as file:
        data = file.read(max_bytes + 1)
    if len(data) > max_bytes:
        raise OSError(f"{path} is longer than {max_bytes} bytes")
    return data.decode(errors="replace")


def _parts(type: str) -> "re.Match[str] | None":
    return _TYPE.fullmatch(type) if len(type) <= _LONGEST_NAME else None


def install_prefixes() -> list[Path]:
    """Return where packages are installed: what was sourced, then wheels beside this Python."""
    sourced = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(each) for each in (*sourced, sysconfig.get_path("data")) if each]


def _listed(resource: Path) -> frozenset[str] | None:
    try:
        return frozenset(read_text(resource, MAX_FILE_BYTES).splitlines())
    except OSError:
        return None


def _first_part(installed: InstalledType) -> str:
    """Return a message, a service's request or an action's goal as its file defines it."""
    path = installed.file(installed.kind)
    try:
        lines = read_text(path, MAX_TEXT).splitlines()
    except OSError as error:
        raise SourceError(
            f"no definition of {installed.type} can be read: {error}",
            help=f"reinstall the package {installed.package}",
        ) from error
    return "\n".join(lines[: lines.index("---")] if "---" in lines else lines)


def _types_in(name: str, text: str) -> list[str]:
    try:
        fields = parse_sections(name, text)[name].fields
    except InputError as error:
        raise SourceError(f"the definition of {name}: {error}", help=error.help) from error
    return [each.type for each in fields if each.type not in PRIMITIVES]
