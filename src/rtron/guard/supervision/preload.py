"""What the guard's programs need, loaded once before the fork server is made: each has it at once.

In ROS 2 a process pays most for rclpy (0.5 s) and for message types (0.4 s each).
"""

import gc
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module

from rtron.errors import RTronError
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import observations_of
from rtron.guard.core.report_messages import DIAGNOSTICS, STRING, UINT64
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.transport.factory import load_types
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import Plan, build_streams

_ROS2 = (
    "guard.transport.ros2.middleware",
    "guard.transport.ros2.abi_check",
    "guard.audit.ros2.auditor",
    "guard.audit.ros2.intruder_readers",
    "wire.ros2.discovery_tuning",
)


def preload(config: GuardConfig) -> None:
    """Load what the processes of a guard need with this configuration."""
    gc.disable()  # while modules are loaded nothing is garbage
    for name in _modules(config):
        with suppress(ImportError):  # ROS 2 is not here: whoever joins it says so
            import_module(f"rtron.{name}")
    prepare_plan(config.plan)
    gc.freeze()
    gc.enable()


def prepare_plan(plan: Plan) -> None:
    """Read a plan's message types and compile its expressions.

    What fails here fails again when the guard begins, and is reported there.
    """
    encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
    own = [DIAGNOSTICS[encoding].type, STRING.type, UINT64.type]
    types = [each.type for each in build_streams(plan)]
    with suppress(RTronError):
        observations_of(plan)
        load_types(plan.ros, [*own, *types])
        for type in types:
            standard_info(type, encoding)


def _modules(config: GuardConfig) -> Iterator[str]:
    is_dry = config.options.get("dry_run")
    yield "guard.supervision.guard_program"
    yield "guard.dry_run" if is_dry else "guard.supervision.bulk_program"
    if not is_dry and config.plan.incidents.keep:
        yield "guard.supervision.incident_program"
    if config.options.get("link"):
        yield "guard.supervision.link_program"
        yield "guard.link.service_link"
        yield "guard.lanes.command.service_reports"
    if config.plan.ros != 1:
        yield from _ROS2
        if config.plan.cell:
            yield "guard.transport.ros2.celled_transport"
