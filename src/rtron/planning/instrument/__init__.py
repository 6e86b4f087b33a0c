"""Makes an app's launch file a guarded one, without a change to any node."""

from rtron.planning.instrument.instrumented import Instrumented, PlacedRemap, Unenforceable
from rtron.planning.instrument.instrumenting import GUARD_COMMAND, instrument
from rtron.planning.instrument.started import Started
from rtron.planning.instrument.writing import write_instrumented

__all__ = [
    "GUARD_COMMAND",
    "Instrumented",
    "PlacedRemap",
    "Started",
    "Unenforceable",
    "instrument",
    "write_instrumented",
]
