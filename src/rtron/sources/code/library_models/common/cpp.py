"""The world of a machine that runs C++."""

from typing import cast

from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.language_runtime import CppLanguageRuntime


def cpp_runtime(machine: AbstractMachine) -> CppLanguageRuntime:
    """Return the machine's world, which natives of C++ only ever see as C++'s."""
    return cast("CppLanguageRuntime", machine.runtime)
