"""Makes an app's launch file a guarded one, without a change to any node."""

from rtron.planning.instrument.common.guarded_launch import (
    EnforcementGap,
    GuardedLaunch,
    PlacedRemap,
    write_guarded_launch,
)
from rtron.planning.instrument.ros1.instrumentation import instrument_ros1
from rtron.planning.instrument.ros1.runtime_launch import RuntimeLaunchTree
from rtron.planning.instrument.ros2.instrumentation import instrument_ros2

__all__ = [
    "EnforcementGap",
    "GuardedLaunch",
    "PlacedRemap",
    "RuntimeLaunchTree",
    "instrument_ros1",
    "instrument_ros2",
    "write_guarded_launch",
]
