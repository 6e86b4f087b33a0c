"""The message, service and action types that are installed here: classes, texts and hashes.

Type names come from strangers: only what the ament index lists is read or imported.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module

from rtron.errors import InputError, SourceError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.ros2.installed_types import (
    MAX_FILE_BYTES,
    InstalledType,
    get_installed_type,
    read_text,
)

_MAX_TYPES = 256


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


@lru_cache(maxsize=_MAX_TYPES)
def find_interface(type: str) -> Interface:
    """Return an installed type, asked for in either ROS's spelling.

    SourceError, whose help names the package, if it is not installed or cannot be read.
    """
    installed = get_installed_type(type)
    text = installed.definition()
    try:
        md5sum = parse_definition(installed.definition_name, text).md5sum
    except InputError as error:
        raise SourceError(
            f"the definition of {installed.type}: {error}", help=error.help
        ) from error
    return Interface(
        cls=_message_class(installed),
        type=installed.type,
        name=installed.definition_name,
        definition=text,
        md5sum=md5sum,
        type_hash=_type_hash(installed),
    )


def _message_class(installed: InstalledType) -> type:
    try:
        found = getattr(import_module(f"{installed.package}.{installed.kind}"), installed.name)
    except (ImportError, AttributeError) as error:
        raise SourceError(
            f"{installed.type} is listed, but Python cannot import it: {error}",
            help=f"source the workspace that has {installed.package}",
        ) from error
    if not isinstance(found, type):
        raise SourceError(f"{installed.type} is no class")
    return found


def _type_hash(installed: InstalledType) -> str:
    """Return what the installed description says; distributions before Iron have none."""
    try:
        description = json.loads(read_text(installed.file("json"), MAX_FILE_BYTES))
        hashes = {each["type_name"]: each["hash_string"] for each in description["type_hashes"]}
        return str(hashes.get(installed.type, ""))
    except (OSError, ValueError, LookupError, TypeError):
        return ""
