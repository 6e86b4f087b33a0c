"""Which variables of a program hold objects and modules of libraries that are not read."""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir.references import callee_names, ir_nodes

_OTHERS = frozenset(sys.stdlib_module_names) | frozenset(
    [
        *("std", "ros", "rospy", "rclcpp", "rclpy", "tf", "tf2", "tf2_ros", "actionlib", "genpy"),
        *("Eigen", "cv", "cv2", "numpy", "np", "scipy", "matplotlib", "PIL", "yaml", "pandas"),
        *("message_filters", "cv_bridge", "image_transport", "rclcpp_action", "rclcpp_lifecycle"),
    ]
)
"""The first parts of the names of what only computes, or is ROS."""
_MESSAGES = re.compile(r"_(?:msgs|srvs|interfaces)$")
_FILES = frozenset({"open()", "socket()"})
"""What C++ calls to get a file descriptor: a device's, mostly, where a program opens one."""
_READING = re.compile(
    r"(?:get|read|recv|receive|is|has|in|wait|flush|connect|join|init|begin|setup|available"
    r"|reset_(?:in|out)put)(?:_\w+|[A-Z]\w*)?"
)
"""Names of calls that only ask an object, or prepare it."""


@dataclass(frozen=True)
class ExternalLibraries:
    """Tells what a call is made on, by the values that the interpreter found."""

    machine: AbstractMachine

    def called(self, call: ir.Call) -> str:
        """Return the library's object or module that a call acts on; empty if it is of none.

        What only asks it does not act. A function of C++ may get a file descriptor.
        """
        name = next(callee_names(call.function), "")
        if _READING.fullmatch(name) or self.machine.runtime.functions_named(name):
            return ""
        if isinstance(call.function, ir.Attr):
            return self.owner(call.function)
        held = (self._values.get(name), *map(self._values.get, self._arguments(call)))
        return next(filter(None, held), "")

    def owner(self, target: ir.Expr) -> str:
        """Return the library's object or module that something is a member or an item of."""
        while isinstance(target, (ir.Attr, ir.Index, ir.Call)):
            target = target.function if isinstance(target, ir.Call) else target.owner
            if found := self._values.get(next(callee_names(target), "")):
                return found
        return ""

    def _arguments(self, call: ir.Call) -> Iterator[str]:
        """Yield the names that a function of C++ gets first: what a descriptor is in."""
        if self.machine.runtime.passes_by_reference:
            yield from chain.from_iterable(map(callee_names, call.args[:1]))

    @cached_property
    def _values(self) -> dict[str, str]:
        """The names of libraries' objects by those of the variables that hold them."""
        found = dict[str, str]()
        members = (getattr(each, "fields", {}) for each in self.machine.instances)
        for fields in chain(members, self.machine.runtime.module_variables()):
            for name, value in fields.items():
                if isinstance(name, str) and (library := self._library(value)):
                    found[name.rpartition("::")[2]] = library
        return found | dict(self._locals(found))

    def _locals(self, known: dict[str, str]) -> Iterator[tuple[str, str]]:
        """Yield the variables of functions that a module's class makes."""
        for _, function in self.machine.runtime.program_functions():
            for node in ir_nodes(function.body):
                if isinstance(node, ir.Assign) and isinstance(node.value, ir.Call):
                    root = node.value.function
                    while isinstance(root, ir.Attr):
                        root = root.owner
                    library = known.get(next(callee_names(root), ""))
                    names = chain.from_iterable(map(callee_names, node.targets))
                    yield from ((name, library) for name in names if library)

    def _library(self, value: av.Value) -> str:
        """Return what a value is of, as its library calls it; empty if it is of the program."""
        return next(filter(None, map(self._name, av.options(value))), "")

    def _name(self, value: av.Value) -> str:
        is_cpp = self.machine.runtime.passes_by_reference
        if isinstance(value, av.ExternalSymbol):
            name = value.name
        elif isinstance(value, av.Unknown):
            name = str(value.type or value.label)
        else:
            return ""
        if is_cpp and name in _FILES:
            return name
        first = re.split(r"[.:(<]", name, maxsplit=1)[0]
        is_named = "::" in name or "." in name or isinstance(value, av.ExternalSymbol)
        is_other = first in _OTHERS or _MESSAGES.search(first)
        return name.removesuffix("()") if is_named and first and not is_other else ""
