"""Where a running app is, and which ROS it speaks."""

import os
from dataclasses import dataclass
from importlib.util import find_spec

from rtron.cli.support.options import DEFAULT_TIMEOUT, Ros
from rtron.errors import InputError, RTronError, SourceError
from rtron.sources.source import GraphSource
from rtron.wire.ros1.host_address import master_uri

DISCOVERY_TIMEOUT = 15.0
_NAME = "/rtron_scan"
_VERSIONS = {"1": Ros.ONE, "2": Ros.TWO}


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveApp:
    """What the options say of a running app: a ROS 1 master, or a ROS 2 domain.

    `timeout` is in seconds; None is the default of the ROS in question.
    """

    ros: Ros
    master: str
    domain: int | None
    timeout: float | None

    def open_source(self) -> tuple[GraphSource, str]:
        """Return where to read the app, and how that is said; SourceError if no ROS is there."""
        if self._detect_ros() is Ros.TWO:
            return self._ros2_source()
        from rtron.guard.master_proxy.master_file import find_private_master  # noqa: PLC0415 - only ROS 1 needs it
        from rtron.sources.live.ros1.source import Ros1LiveSource  # noqa: PLC0415

        source = Ros1LiveSource(find_private_master(self.master), self.timeout or DEFAULT_TIMEOUT)
        return source, f"the app running at {self.master}"

    def _ros2_source(self) -> tuple[GraphSource, str]:
        try:
            from rtron.sources.live.ros2.source import Ros2LiveSource  # noqa: PLC0415 - needs a ROS 2
        except ImportError as error:
            help = "source your ROS 2 (. /opt/ros/…/setup.bash), or pip install 'rtron[ros2]'"
            raise SourceError(f"ROS 2 is not there: {error}", help=help) from error
        source = Ros2LiveSource(self.domain, self.timeout or DISCOVERY_TIMEOUT)
        return source, f"the app running in {source.domain_description}"

    def _detect_ros(self) -> Ros:
        """Return which ROS is meant: as told, as sourced, or the only one that is there."""
        sourced = _VERSIONS.get(os.environ.get("ROS_VERSION", ""))
        requested = self.ros if self.ros is not Ros.AUTO else self._ros_from_address() or sourced
        return requested or detect_only_ros(self.master)

    def _ros_from_address(self) -> Ros | None:
        """Return the ROS whose place somebody typed: it is another than the environment's."""
        master, domain = self.master != master_uri(), self.domain is not None
        if master and domain:
            help = "ROS 1 has a master, ROS 2 a domain: leave one out, or say --ros 1 or --ros 2"
            raise InputError("both --master and --domain are given", help=help)
        return Ros.ONE if master else Ros.TWO if domain else None

    @property
    def command_line(self) -> str:
        """The arguments that lead to the same app again."""
        words = ["--live"]
        words += ["--ros", self.ros.value] if self.ros is not Ros.AUTO else []
        words += ["--domain", str(self.domain)] if self.domain is not None else []
        return " ".join(words)


def detect_only_ros(master: str) -> Ros:
    """Return the ROS that is there; SourceError if both are, or none."""
    answers, installed = _master_answers(master), find_spec("rclpy") is not None
    if answers and installed:
        help = "say which one you mean: --ros 1 or --ros 2 (a sourced ROS says it: ROS_VERSION)"
        raise SourceError(f"a master answers at {master}, and ROS 2 is here, too", help=help)
    if not answers and not installed:
        help = (
            "ROS 1: is the app running (`roscore`)? name its master with --master. "
            "ROS 2: source it, or pip install 'rtron[ros2]'"
        )
        raise SourceError(f"no master answers at {master}, and no ROS 2 is installed", help=help)
    return Ros.ONE if answers else Ros.TWO


def _master_answers(master: str) -> bool:
    from rtron.wire.ros1.xmlrpc import ros_call  # noqa: PLC0415 - only who asks a master needs it

    try:
        ros_call(master, "getPid", _NAME, timeout=DEFAULT_TIMEOUT)
    except RTronError:
        return False
    return True
