"""The world of a machine that runs C++."""

from typing import cast

from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.language_runtime import Cpp


def cpp(machine: Machine) -> Cpp:
    """Return the machine's world, which natives of C++ only ever see as C++'s."""
    return cast("Cpp", machine.world)
