"""Whether SROS2 is really in force in a running app: seen from within, and tried from outside."""

from __future__ import annotations

import os
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros2.domain_probe import probe_domain
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.live_verification import verify_domain
from rtron.guard.audit.ros2.observed_graph import ROSOUT_TOPIC, ObservedGraph
from rtron.guard.audit.ros2.verification import verify_ros2
from rtron.vocabulary import VERIFY_NODE
from rtron.wire.ros2.domain_id import domain_id
from rtron.wire.ros2.service_names import is_service_topic, ros_name

if TYPE_CHECKING:
    from pathlib import Path

    from rtron.vocabulary import Plan
    from rtron.vocabulary.verification import Verification
    from rtron.wire.ros2.session import Ros2Session

_SECURITY = "ROS_SECURITY_"
_WHY = "is ROS_SECURITY_STRATEGY=Enforce, so spelled, in its environment?"
_WIDE = "compare the keystore with `rtron secure --diff`"


def verify_secured_domain(
    plan: Plan, keystore: Path, timeout: float, domain: int | None = None
) -> Verification:
    """Audit a running app as `verify_domain` does, with a certificate, and try it without one.

    What is seen without a certificate has none, and what a certificate that is not the guard's may
    publish is not closed: each is a problem.
    """
    seen = _seen_without_certificate(plan, domain_id(domain))
    os.environ |= {
        f"{_SECURITY}ENABLE": "true",
        f"{_SECURITY}STRATEGY": "Enforce",
        f"{_SECURITY}KEYSTORE": str(keystore.absolute()),
    }
    try:
        verification = verify_domain(plan, timeout, domain)
    except SourceError:
        if not seen:
            raise
        verification = verify_ros2(plan, ObservedGraph(()))
    accepted, refused = _try_to_publish(plan, domain)
    problems = [f"{each} is there without a certificate: {_WHY}" for each in seen]
    problems += [f"the enclave {VERIFY_NODE} may publish {each}: {_WIDE}" for each in accepted]
    proven = [f"the enclave {VERIFY_NODE} may not publish {each}" for each in refused]
    proven += [] if seen else ["a participant without a certificate sees nobody"]
    return replace(verification, problems=(*verification.problems, *problems), proven=tuple(proven))


def _seen_without_certificate(plan: Plan, domain: int) -> list[str]:
    """Return what a participant without a certificate sees, another process's."""
    found = probe_domain(domain, (*ExpectedGraph(plan).topics, ROSOUT_TOPIC))
    unnamed = {each.topic for each in found.endpoints if not each.node}
    return sorted({*found.nodes, *(f"somebody on {topic}" for topic in unnamed)})


def _try_to_publish(plan: Plan, domain: int | None) -> tuple[list[str], list[str]]:
    """Return on which private outputs an enclave that is not the guard's may and may not speak."""
    from rtron.wire.ros2.session import Ros2Session  # noqa: PLC0415 - only where ROS 2 is chosen

    outputs = sorted(set(ExpectedGraph(plan).outputs.values()))
    with closing(Ros2Session(domain, VERIFY_NODE)) as session:
        accepted = [ros_name(each) for each in outputs if _may_speak(session, each)]
    return accepted, [name for name in map(ros_name, outputs) if name not in accepted]


def _may_speak(session: Ros2Session, output: str) -> bool:
    """Tell whether the middleware gives us a writer; it says no more than that of a permission."""
    from rtron.wire.ros2.interfaces import find_interface  # noqa: PLC0415

    node = session.node(VERIFY_NODE)
    try:
        if is_service_topic(output):
            service = find_interface("rcl_interfaces/srv/GetParameters").cls
            node.destroy_client(node.create_client(service, ros_name(output)))
        else:
            node.destroy_publisher(
                node.create_publisher(find_interface("std_msgs/Empty").cls, output, 1)
            )
    except RuntimeError:
        return False
    return True
