"""What the demo asks of the running app, all of it through ROS parameters."""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from math import degrees
from typing import Any

from rtron.errors import RTronError, SourceError
from rtron.wire.xmlrpc import ros_call

_NAME = "/rtron_demo"
_CALL_LIMIT = 2.0
_WAIT_LIMIT = 60.0
_PAUSE = 0.1
_NODES = {"/camera", "/detector", "/goal_sender", "/navigator", "/tb3_safe_control", "/driver"}


@dataclass(frozen=True, slots=True)
class Drive:
    """What happened on one drive: messages sent and arrived, and where the robot ended up."""

    forward_sent: int
    forward_arrived: int
    right_sent: int
    right_arrived: int
    x: float
    turned_right: float
    """How far the robot was turned to the right, degrees."""


@dataclass(frozen=True, slots=True)
class Robot:
    """The app at a ROS master."""

    master: str

    def wait_for_master(self) -> None:
        """Wait until the master answers."""
        self._wait("the ROS master", lambda: self._ask("getPid") is not None)

    def wait_until_ready(self, topic: str = "/cmd_vel") -> None:
        """Wait until all nodes are there and the driver is connected to whoever feeds it."""
        self._wait("the app's nodes", self._is_complete)
        self._wait(f"{topic} to reach the driver", self._is_connected)

    def drive(self, before: float, under_attack: float) -> Drive:
        """Drive for `before` seconds alone and then under attack, and return what happened."""
        self._set(drive=True)
        time.sleep(before)
        self._set(attack=True)
        time.sleep(under_attack)
        self._set(drive=False, attack=False)
        time.sleep(0.5)
        return self._outcome()

    def forget(self) -> None:
        """Delete what the last drive left in the parameter server, once its nodes are gone."""
        self._wait("the app to end", lambda: not any(map(self._answers, _NODES & self._nodes())))
        for name in ("/demo", "/navigator", "/driver", "/tb3_safe_control"):
            with suppress(SourceError):
                self._ask("deleteParam", name)

    def _set(self, **values: bool) -> None:
        for name, value in values.items():
            ros_call(self.master, "setParam", _NAME, f"/demo/{name}", value, timeout=_CALL_LIMIT)

    def _outcome(self) -> Drive:
        state = self._parameter("/driver/state")
        return Drive(
            forward_sent=self._parameter("/navigator/sent"),
            forward_arrived=state["forward"],
            right_sent=self._parameter("/tb3_safe_control/sent"),
            right_arrived=state["right"],
            x=state["x"],
            turned_right=-degrees(state["heading"]),
        )

    def _is_complete(self) -> bool:
        counted = map(self._parameter, ("/tb3_safe_control/sent", "/driver/state"))
        ready = self._parameter("/navigator/ready") is True and None not in counted
        return ready and self._nodes() >= _NODES

    def _is_connected(self) -> bool:
        """Tell whether both senders have a connection out, and the driver one in, for commands."""
        return (
            self._connections("/navigator", "o")
            and self._connections("/tb3_safe_control", "o")
            and self._connections("/driver", "i")
        )

    def _connections(self, node: str, direction: str) -> bool:
        try:
            uri = self._ask("lookupNode", node)
            found = ros_call(uri, "getBusInfo", _NAME, timeout=_CALL_LIMIT)
        except RTronError:
            return False
        return any(row[2] == direction and "cmd_vel" in row[4] for row in found)

    def _answers(self, node: str) -> bool:
        """Tell whether a node lives; one that was ended by force stays registered."""
        try:
            ros_call(self._ask("lookupNode", node), "getPid", _NAME, timeout=_CALL_LIMIT)
        except RTronError:
            return False
        return True

    def _nodes(self) -> set[str]:
        state = self._ask("getSystemState")
        return {node for side in state for _, nodes in side for node in nodes}

    def _parameter(self, name: str) -> Any:  # noqa: ANN401 - a parameter has any type
        try:
            return self._ask("getParam", name)
        except SourceError:
            return None

    def _ask(self, method: str, *arguments: str) -> Any:  # noqa: ANN401
        return ros_call(self.master, method, _NAME, *arguments, timeout=_CALL_LIMIT)

    def _wait(self, what: str, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + _WAIT_LIMIT
        while not _holds(condition):
            if time.monotonic() > deadline:
                raise SourceError(f"waited {_WAIT_LIMIT:g} s for {what}")
            time.sleep(_PAUSE)


def _holds(condition: Callable[[], bool]) -> bool:
    try:
        return condition()
    except SourceError:
        return False
