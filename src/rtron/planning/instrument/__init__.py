"""Makes an app's launch file a guarded one, without a change to any node."""

from rtron.planning.instrument.common.file_writer import write_instrumented
from rtron.planning.instrument.common.guarded_launch import Instrumented, PlacedRemap, Unenforceable
from rtron.planning.instrument.ros1.instrumentation import GUARD_COMMAND, instrument
from rtron.planning.instrument.ros1.runtime_launch import Started

__all__ = [
    "GUARD_COMMAND",
    "Instrumented",
    "PlacedRemap",
    "Started",
    "Unenforceable",
    "instrument",
    "write_instrumented",
]
