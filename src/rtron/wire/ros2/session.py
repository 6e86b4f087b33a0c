"""RTron's own place in a ROS 2 domain: a context, and nodes with nothing that was not asked for.

The domain, the range of discovery and the RMW are those of the environment (`ROS_DOMAIN_ID`,
`ROS_AUTOMATIC_DISCOVERY_RANGE` or `ROS_LOCALHOST_ONLY`, `RMW_IMPLEMENTATION`), unless told. So is
whether SROS2 is on, and with which keystore (`ROS_SECURITY_ENABLE`, `ROS_SECURITY_STRATEGY`,
`ROS_SECURITY_KEYSTORE`).

Type names come from strangers: only what the ament index lists is read or imported.
"""

from __future__ import annotations

import os
import uuid
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING

import rclpy
from rclpy.context import Context
from rclpy.node import Node

from rtron.errors import SourceError
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT
from rtron.wire.ros2.discovery_tuning import large_receive_buffers
from rtron.wire.ros2.domain_id import domain_id
from rtron.wire.ros2.endpoints import await_publishers

if TYPE_CHECKING:
    from collections.abc import Iterator
import json
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module

from rtron.errors import InputError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.ros2.installed_types import (
    MAX_FILE_BYTES,
    InstalledType,
    get_installed_type,
    read_text,
)

_HELP = "look at ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE and RMW_IMPLEMENTATION"
_SECURITY_HELP = (
    "ROS_SECURITY_ENABLE is true: look at ROS_SECURITY_KEYSTORE, and run `rtron secure --diff`"
)


class Ros2Session:
    """One participant of the domain; `close` ends it with all of its nodes.

    Under SROS2 it has the identity of `enclave`. InputError if there is no such domain, SourceError
    if it cannot be joined.
    """

    def __init__(self, domain: int | None = None, enclave: str = GUARD_NODE) -> None:
        self.domain = domain_id(domain)
        self.context = Context()
        self._nodes: dict[str, Node] = {}
        with _as_source_error():
            self.context.init(args=["--ros-args", "--enclave", enclave], domain_id=self.domain)

    def node(self, name: str) -> Node:
        """Return our node of this full name; ROS 2's own remaps do not reach it.

        The first one opens the participant.
        """
        if name not in self._nodes:
            space, _, base = name.rpartition("/")
            tuning = nullcontext() if self._nodes else large_receive_buffers()
            with tuning, _as_source_error():
                self._nodes[name] = self._create_node(base, space)
        return self._nodes[name]

    def _create_node(self, base: str, space: str) -> Node:
        return Node(
            base,
            context=self.context,
            namespace=space or "/",
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )

    def destroy_node(self, name: str) -> None:
        """Take a node out of the graph."""
        node = self._nodes.pop(name, None)
        if node:
            node.destroy_node()

    def participant(self, name: str) -> bytes:
        """Return which participant our node `name` is in; SourceError if the RMW does not tell.

        It is seen at a publisher whose topic nobody else can know.
        """
        node, topic = self.node(name), f"{PRIVATE_ROOT}/self_{uuid.uuid4().hex}"
        publisher = node.create_publisher(find_interface("std_msgs/Empty").cls, topic, 1)
        try:
            found = {each.participant for each in await_publishers(node, topic, 1)}
        finally:
            node.destroy_publisher(publisher)
        if len(found) != 1:
            raise SourceError("this RMW does not tell which endpoints are ours", help="use a DDS")
        return found.pop()

    def close(self) -> None:
        """Leave the domain."""
        for name in list(self._nodes):
            self.destroy_node(name)
        self.context.try_shutdown()


@contextmanager
def _as_source_error() -> Iterator[None]:
    """Say what to look at where ROS 2 cannot be joined."""
    try:
        yield
    except RuntimeError as error:
        is_secure = os.environ.get("ROS_SECURITY_ENABLE") == "true"
        help = _SECURITY_HELP if is_secure else _HELP
        raise SourceError(f"ROS 2 cannot be joined: {error}", help=help) from error


def rmw_identifier() -> str:
    """Return which RMW the environment has chosen, for example `rmw_fastrtps_cpp`."""
    return str(rclpy.get_rmw_implementation_identifier())


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
