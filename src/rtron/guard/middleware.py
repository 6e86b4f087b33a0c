"""The middleware of a guard: its transport, and the audit of its graph."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from rtron.guard.audit.ros1.auditor import Ros1Auditor
from rtron.guard.transport.factory import open_ros1_transport, open_ros2_transport

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.coordinator import Coordinator
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import LiveTransport
    from rtron.vocabulary import Plan
    from rtron.wire.ros2.session import Ros2Session


class Auditor(Protocol):
    """Checks the running graph against the plan."""

    def start(self) -> None:
        """Start the audit; the coordinator is open."""
        ...

    def close(self) -> None:
        """Stop the audit."""
        ...


@dataclass(frozen=True, slots=True)
class Middleware:
    """A transport, and a function that creates the auditor of a coordinator on it."""

    transport: LiveTransport
    create_auditor: Callable[[Coordinator], Auditor]


def open_middleware(
    plan: Plan,
    address: str,
    loop: EventLoop,
    *,
    dry_run: bool,
    session: Ros2Session | None = None,
) -> Middleware:
    """Return the middleware of a plan, at a master or in a domain; see `open_transport`.

    `session` is in the domain already.
    """
    if plan.ros == 1:
        ros1 = open_ros1_transport(address, loop)
        return Middleware(
            ros1,
            lambda coordinator: Ros1Auditor(
                plan, ros1.master, coordinator, ros1, loop, dry_run=dry_run
            ),
        )
    ros2 = open_ros2_transport(address, loop, session)
    from rtron.guard.audit.ros2.auditor import Ros2Auditor  # noqa: PLC0415 - it needs rclpy

    return Middleware(
        ros2, lambda coordinator: Ros2Auditor(plan, coordinator, ros2, loop, dry_run=dry_run)
    )
