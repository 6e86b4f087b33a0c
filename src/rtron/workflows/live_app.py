"""Where a running app is, and which ROS it speaks."""

import os
from dataclasses import dataclass
from enum import Enum
from importlib.util import find_spec
from typing import TYPE_CHECKING

from rtron.errors import InputError, RTronError, SourceError
from rtron.wire.ros2.domain_id import domain_address

if TYPE_CHECKING:
    from rtron.sources.source import GraphSource

ANSWER_TIMEOUT_S = 5.0
DISCOVERY_TIMEOUT_S = 15.0
_NODE_NAME = "/rtron_scan"


class RosGeneration(str, Enum):
    """The ROS that a running app speaks."""

    AUTO = "auto"
    ONE = "1"
    TWO = "2"


_VERSIONS = {"1": RosGeneration.ONE, "2": RosGeneration.TWO}


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveApp:
    """A running app: the nodes of a ROS 1 master, or of a ROS 2 domain.

    `timeout` is in seconds; None is the default of the ROS in question.
    """

    ros: RosGeneration
    master: str
    domain: int | None
    timeout: float | None

    def open_source(self) -> "tuple[GraphSource, str]":
        """Return the source and its description; SourceError if no ROS is there."""
        if self._detect_ros() is RosGeneration.TWO:
            return self._ros2_source()
        from rtron.guard.master_proxy.master_file import find_private_master  # noqa: PLC0415 - only ROS 1 needs it
        from rtron.sources.live.ros1.source import Ros1LiveSource  # noqa: PLC0415

        source = Ros1LiveSource(find_private_master(self.master), self.timeout or ANSWER_TIMEOUT_S)
        return source, f"the app running at {self.master}"

    def _ros2_source(self) -> "tuple[GraphSource, str]":
        try:
            from rtron.sources.live.ros2.source import Ros2LiveSource  # noqa: PLC0415 - needs a ROS 2
        except ImportError as error:
            help = "source your ROS 2 (. /opt/ros/…/setup.bash), or pip install 'rtron[ros2]'"
            raise SourceError(f"ROS 2 is not there: {error}", help=help) from error
        source = Ros2LiveSource(self.domain, self.timeout or DISCOVERY_TIMEOUT_S)
        return source, f"the app running in {source.domain_description}"

    def _detect_ros(self) -> RosGeneration:
        """Return the requested ROS, else the sourced one, else the only one that is there."""
        if self.ros is not RosGeneration.AUTO:
            return self.ros
        sourced = _VERSIONS.get(os.environ.get("ROS_VERSION", ""))
        return self._ros_from_address() or sourced or _detect_only_ros(self.master)

    def _ros_from_address(self) -> RosGeneration | None:
        """Return the ROS whose address differs from that of the environment."""
        from rtron.wire.ros1.network import master_uri  # noqa: PLC0415 - not for a command's help

        master, domain = self.master != master_uri(), self.domain is not None
        if master and domain:
            help = "ROS 1 has a master, ROS 2 a domain: leave one out, or say --ros 1 or --ros 2"
            raise InputError("both --master and --domain are given", help=help)
        return RosGeneration.ONE if master else RosGeneration.TWO if domain else None

    @property
    def command_line(self) -> str:
        """The arguments that lead to the same app again."""
        words = ["--live"]
        words += ["--ros", self.ros.value] if self.ros is not RosGeneration.AUTO else []
        words += ["--domain", str(self.domain)] if self.domain is not None else []
        return " ".join(words)


def app_address(ros: int, master: str, domain: int | None) -> str:
    """Return where an app of this ROS runs: its master's address, or that of its domain."""
    return master if ros == 1 else domain_address(domain)


def _detect_only_ros(master: str) -> RosGeneration:
    """Return the ROS that is there; SourceError if both are, or none."""
    answers = master_answers(master, _NODE_NAME, ANSWER_TIMEOUT_S)
    installed = find_spec("rclpy") is not None
    if answers and installed:
        help = "say which one you mean: --ros 1 or --ros 2 (a sourced ROS says it: ROS_VERSION)"
        raise SourceError(f"a master answers at {master}, and ROS 2 is here, too", help=help)
    if not answers and not installed:
        help = (
            "ROS 1: is the app running (`roscore`)? name its master with --master. "
            "ROS 2: source it, or pip install 'rtron[ros2]'"
        )
        raise SourceError(f"no master answers at {master}, and no ROS 2 is installed", help=help)
    return RosGeneration.ONE if answers else RosGeneration.TWO


def master_answers(uri: str, caller: str, timeout: float) -> bool:
    """Return whether a ROS 1 master answers the node `caller` within `timeout` seconds."""
    from rtron.wire.ros1.xmlrpc import ros_call  # noqa: PLC0415 - only who asks a master needs it

    try:
        ros_call(uri, "getPid", caller, timeout=timeout)
    except RTronError:
        return False
    return True
