"""What the command process does for the bulk process."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rtron.guard.audit.common.alarm_response import Brakes
from rtron.guard.lanes.messages import (
    ApplySettings,
    HoldStream,
    RegisterNode,
    ReleaseStream,
    RepeatStop,
)

if TYPE_CHECKING:
    from rtron.vocabulary import Settings


class Orders:
    """Does what the bulk process asks for."""

    def __init__(
        self,
        brakes: Brakes,
        register_node: Callable[[str], None],
    ) -> None:
        self.apply: Callable[[Settings], None] = lambda settings: None
        """Puts settings in force, where there is a security service."""
        self._brakes = brakes
        self._register_node = register_node

    def obey(self, message: object) -> None:
        """Do what one message says."""
        match message:
            case HoldStream(topic, reason):
                self._brakes.hold(topic, reason)
            case ReleaseStream(topic):
                self._brakes.release(topic)
            case RepeatStop(topic):
                self._brakes.repeat_stop(topic)
            case RegisterNode(name):
                self._register_node(name)
            case ApplySettings(settings):
                self.apply(settings)
