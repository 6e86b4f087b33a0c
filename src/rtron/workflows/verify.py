"""Verify that a running app sends all guarded traffic through the guard."""

from typing import TYPE_CHECKING

from rtron.vocabulary import Plan

if TYPE_CHECKING:
    from rtron.vocabulary.verification import Verification


def verify_running_app(
    plan: Plan, master: str, domain: int | None, timeout: float
) -> "Verification":
    """Return the state of each path of the plan, in its ROS; `timeout` is in seconds.

    Raise SourceError if the running app cannot be read.
    """
    if plan.ros != 1:
        from rtron.guard.audit.ros2.live_verification import verify_domain  # noqa: PLC0415 - needs a ROS 2

        return verify_domain(plan, timeout, domain)
    from rtron.guard.audit.ros1.live_verification import verify_live  # noqa: PLC0415 - only ROS 1 needs it
    from rtron.guard.master_proxy.master_file import find_private_master  # noqa: PLC0415

    return verify_live(plan, find_private_master(master), timeout)
