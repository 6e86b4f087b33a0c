"""Verify that a running app sends all guarded traffic through the guard."""

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.errors import InputError, suggestion
from rtron.vocabulary import Mode, Plan, build_streams, matches_node

if TYPE_CHECKING:
    from rtron.vocabulary.verification import Verification


def verify_running_app(
    plan: Plan,
    master: str,
    domain: int | None,
    timeout: float,
    *,
    absent: Collection[str] = (),
    keystore: Path | None = None,
) -> "Verification":
    """Return the state of each path of the plan, in its ROS; `timeout` is in seconds.

    `absent` are nodes of the plan that are switched off, names or patterns. With a `keystore` the
    app has to be under SROS2, which is tried. Raise SourceError if the running app cannot be read,
    InputError if the plan has no such node, or is for ROS 1 and a keystore is given.
    """
    _check_absent(plan, absent)
    if keystore is None:
        return _verify(plan, master, domain, timeout).without(absent)
    if plan.ros == 1:
        raise InputError("ROS 1 has no enclaves", help="leave --keystore out; see `rtron master`")
    from rtron.security.live.enforcement import verify_secured_domain  # noqa: PLC0415 - needs a ROS 2

    return verify_secured_domain(plan, keystore, timeout, domain).without(absent)


def _check_absent(plan: Plan, absent: Collection[str]) -> None:
    """Refuse a name that no node of the plan has: a slip would go unnoticed."""
    enforced = [stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE]
    known = {node for stream in enforced for node in stream.successors}
    known |= {flow.publisher for stream in enforced for flow in stream.flows}
    for name in absent:
        if not any(matches_node(name, node) for node in known):
            raise InputError(f"the plan has no node {name}", help=suggestion(name, sorted(known)))


def _verify(plan: Plan, master: str, domain: int | None, timeout: float) -> "Verification":
    if plan.ros != 1:
        from rtron.guard.audit.ros2.live_verification import verify_domain  # noqa: PLC0415 - needs a ROS 2

        return verify_domain(plan, timeout, domain)
    from rtron.guard.audit.ros1.live_verification import verify_live  # noqa: PLC0415 - only ROS 1 needs it

    return verify_live(plan, master, timeout)
