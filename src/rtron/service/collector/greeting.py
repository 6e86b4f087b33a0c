"""What the collector asks of the risk controller when a guard connects and answers."""

from typing import Protocol

from rtron.vocabulary import Settings
from rtron.wire.common.link_protocol import Applied, Hello


class HandshakeHandler(Protocol):
    """Both are called in threads, never in the event loop; they may be called again alike."""

    def handle_hello(self, robot: str, hello: Hello) -> Settings:
        """Keep the robot's app, plan and coordination nodes; return the settings to put in force.

        RTronError refuses the guard; its text is told.
        """

    def handle_applied(self, robot: str, applied: Applied) -> None:
        """Note that the guard has put settings in force, or why it has not."""
