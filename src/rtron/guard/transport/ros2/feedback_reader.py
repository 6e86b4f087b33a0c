"""The feedback of an action of ROS 2, as a client of it reads it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.transport.ros2.data_reader import DataReader
from rtron.guard.transport.ros2.qos import profile
from rtron.vocabulary import QoS, Ros2ActionEntity, ros2_entity_name
from rtron.wire.ros2.interfaces import find_interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.transport.ros2.context import TransportContext

_DEPTH = 10


class FeedbackReader:
    """Passes on each feedback message of an action, whoever sends it.

    SourceError if the action's type is not installed.
    """

    def __init__(
        self,
        node: Node,
        action: str,
        type: str,
        context: TransportContext,
        on_feedback: Callable[[bytes], None],
    ) -> None:
        self._on_feedback = on_feedback
        cls = find_interface(type).cls
        self._reader = DataReader(
            node,
            cls.Impl.FeedbackMessage,  # type: ignore[attr-defined]
            ros2_entity_name(action, Ros2ActionEntity.FEEDBACK),
            profile(QoS(), _DEPTH),
            context,
            self,
            is_command=False,
        )

    def close(self) -> None:
        """Read no more."""
        self._reader.close()

    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> bool:
        """Pass on a message; see `DataListener`."""
        del reader, gid, number
        self._on_feedback(message)
        return True

    def note_late(self, reader: DataReader, gid: bytes, number: int | None) -> None:
        """Do nothing: feedback is never late."""

    def note_replaced(self, count: int) -> None:
        """Do nothing: newer feedback replaces older one."""
