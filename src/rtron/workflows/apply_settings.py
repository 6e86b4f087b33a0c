"""Apply settings to a running guard through the security service, and wait for its answer."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from rtron.workflows.service_client import SecurityServiceClient

View: TypeAlias = Mapping[str, Any]
"""A resource of the service's API, as it comes in JSON."""
_POLL_S = 0.05
_PENDING, _REFUSED = "pending", "refused"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedNode:
    """A coordination node as the plan has it, and the revision of the settings when it was read."""

    id: str
    revision: int
    flow_names: Sequence[str]
    has_rules: bool


@dataclass(frozen=True, slots=True)
class AppliedSettings:
    """A revision of a robot's settings; it failed if the guard rejects it or does not answer."""

    view: View
    has_failed: bool


@dataclass(frozen=True, slots=True)
class RobotSettings:
    """The settings of one robot in the security service.

    A change waits up to `timeout` seconds for the guard's answer; with None it does not wait. The
    errors are those of the client.
    """

    client: SecurityServiceClient
    robot: str
    timeout: float | None = None

    def view(self) -> View:
        """Return the settings in force."""
        view: View = self._get("settings")
        return view

    def node(self, node: str) -> View:
        """Return a coordination node with its plan and its settings."""
        view: View = self._get("nodes", node)
        return view

    def nodes(self) -> Sequence[View]:
        """Return all coordination nodes."""
        nodes: Sequence[View] = self._get("nodes")
        return nodes

    def planned_node(self, node: str) -> PlannedNode:
        """Return what can be set at a coordination node."""
        revision = self.view()["revision"]
        plan = self.node(node)["plan"]
        return PlannedNode(
            id=node, revision=revision, flow_names=_flow_names(plan), has_rules="rules" in plan
        )

    def change(self, node: PlannedNode, patch: View, reason: str) -> AppliedSettings:
        """Change a coordination node, unless somebody else has changed the settings meanwhile."""
        body = {"revision": node.revision, "nodes": {node.id: patch}, "reason": reason}
        return self._applied(self.client.patch("robots", self.robot, "settings", body=body))

    def stop(self, reason: str) -> AppliedSettings:
        """Stop the robot, or send the stop again."""
        body = {"reason": reason}
        return self._applied(self.client.post("robots", self.robot, "stop", body=body))

    def release(self, revision: int, reason: str) -> AppliedSettings:
        """End the emergency stop that the settings of this revision have."""
        body = {"reason": reason, "revision": revision}
        return self._applied(self.client.delete("robots", self.robot, "stop", body=body))

    def _get(self, *path: str, **query: object) -> Any:  # noqa: ANN401 - JSON
        return self.client.get("robots", self.robot, *path, **query)

    def _applied(self, view: View) -> AppliedSettings:
        if self.timeout is None:
            return AppliedSettings(view, has_failed=view["outcome"] == _REFUSED)
        view = self._wait_for_answer(view, time.monotonic() + self.timeout)
        return AppliedSettings(view, has_failed=view["outcome"] in (_REFUSED, _PENDING))

    def _wait_for_answer(self, view: View, deadline: float) -> View:
        """Return the settings once the guard has answered them, or as they are at the deadline."""
        before = view["revision"] + 1
        while view["outcome"] == _PENDING and time.monotonic() < deadline:
            time.sleep(_POLL_S)
            (view,) = self._get("settings", "history", before=before, limit=1)
        return view


def _flow_names(plan: View) -> list[str]:
    """Return the names of the flows that can be set at a coordination node."""
    guarded = [*plan.get("vflows", ()), *plan.get("aflows", ())]
    flows = [*plan.get("flows", ()), *(flow for topic in guarded for flow in topic["flows"])]
    return [flow["name"] for flow in flows]
