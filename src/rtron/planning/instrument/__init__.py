"""Makes an app's launch file a guarded one, without a change to any node."""

from rtron.planning.instrument.common.file_writer import write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import (
    EnforcementGap,
    GuardedLaunch,
    PlacedRemap,
)
from rtron.planning.instrument.ros1.instrumentation import GUARD_COMMAND, instrument
from rtron.planning.instrument.ros1.runtime_launch import RuntimeLaunchTree

__all__ = [
    "GUARD_COMMAND",
    "EnforcementGap",
    "GuardedLaunch",
    "PlacedRemap",
    "RuntimeLaunchTree",
    "instrument",
    "write_guarded_launch",
]
