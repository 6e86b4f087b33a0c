"""Roll-outs of the security service: begin, look at, control and follow them."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from rtron.errors import InputError, SourceError
from rtron.workflows.apply_settings import PlannedNode, RobotSettings, View
from rtron.workflows.service_client import SecurityServiceClient

_POLL_S = 1.0
_LAST_STATES = frozenset({"done", "reverted", "cancelled"})
_SHOWN = ("state", "stage", "note", "waiting", "sent", "applied", "reverted", "stuck", "problems")
"""Those who follow a roll-out are shown it again when one of these differs."""


@dataclass(frozen=True, slots=True)
class RolloutClient:
    """Roll-outs through a service's API; the errors are those of the client."""

    client: SecurityServiceClient

    def planned_node(self, robots: Mapping[str, Any], node: str) -> PlannedNode:
        """Return what can be set at a node of the first of the chosen robots that has an app."""
        found = RobotSettings(self.client, self._first_robot(robots)).planned_node(node)
        return replace(found, revision=0)

    def start(self, rollout: View) -> View:
        """Begin a roll-out, as the API takes it."""
        started: View = self.client.post("rollouts", body=rollout)
        return started

    def newest(self, number: int) -> Sequence[View]:
        """Return the newest roll-outs in short, the newest first."""
        page: Sequence[View] = self.client.get("rollouts", limit=number)["rollouts"]
        return page

    def view(self, id: int) -> View:
        """Return a roll-out in full."""
        view: View = self.client.get("rollouts", str(id))
        return view

    def robots(self, id: int) -> Iterator[View]:
        """Yield its robots in the order of getting the change."""
        after = None
        while True:
            page = self.client.get("rollouts", str(id), "robots", after=after, limit=1000)
            yield from page["robots"]
            after = page["next"]
            if after is None:
                return

    def control(self, id: int, action: str, **body: object) -> View:
        """Pause, resume or cancel it; the answer is what it is then."""
        view: View = self.client.post("rollouts", str(id), action, body=body)
        return view

    def follow(self, id: int, on_lost: Callable[[Exception], None]) -> Iterator[View]:
        """Yield a roll-out now and whenever it is at something else, to its end.

        `on_lost` is told of a service that is away later, which is asked again.
        """
        view = self.view(id)
        yield view
        while view["state"] not in _LAST_STATES:
            view = self._wait_for_step(view, on_lost)
            yield view

    def _wait_for_step(self, shown: View, on_lost: Callable[[Exception], None]) -> View:
        while True:
            time.sleep(_POLL_S)
            try:
                view = self.view(shown["id"])
            except SourceError as error:
                on_lost(error)
                continue
            if any(shown[key] != view[key] for key in _SHOWN):
                return view

    def _first_robot(self, robots: Mapping[str, Any]) -> str:
        if robots.get("names"):
            return str(robots["names"][0])
        found = self.client.get("robots", **robots, states="false", limit=1000)
        for robot in found:
            if robot["app"]:
                return str(robot["name"])
        raise InputError("there is no such robot", help="`--group`, `--app` or `--robot` say which")
