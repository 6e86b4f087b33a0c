"""An action of ROS 2 whose plan only observes: requests cannot be seen by a third."""

import logging

from rtron.guard.core.stream import GuardedStream

log = logging.getLogger(__name__)


class ObservedActionStream(GuardedStream):
    """Stands in the reports of the guard, and sees nothing: goals go from client to server."""

    def open(self) -> None:
        """Stay out of the graph."""
        text = "%s: its goals are requests, which only a guard that enforces sees"
        log.warning(text, self.spec.topic)

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        return {"goals": "requests, which nobody else can see"}
