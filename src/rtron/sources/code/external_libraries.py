"""Which variables of a program hold what: its own objects, or those of libraries not read.

Names are kept by scope: the class of a method of C++, else the file of a function. A class and its
bases share one.
"""

import re
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

from rtron.sources.code import ir
from rtron.sources.code.call_kinds import only_reads
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir.references import callee_names, ir_nodes
from rtron.vocabulary import DESCRIPTORS

_OTHERS = frozenset(sys.stdlib_module_names) | frozenset(
    [
        *("std", "ros", "rospy", "rclcpp", "rclpy", "tf", "tf2", "tf2_ros", "actionlib", "genpy"),
        *("Eigen", "cv", "cv2", "numpy", "np", "scipy", "matplotlib", "PIL", "yaml", "pandas"),
        *("message_filters", "cv_bridge", "image_transport", "rclcpp_action", "rclcpp_lifecycle"),
        *("fmt", "spdlog", "nlohmann", "YAML", "torch", "tensorflow", "pcl", "sklearn"),
    ]
)
"""The first parts of the names of what only computes, or is ROS."""
_MESSAGES = re.compile(r"_(?:msgs|srvs|interfaces)$")
_ANYWHERE = ""
"""The scope of what all functions see."""


@dataclass(frozen=True)
class ExternalLibraries:
    """Tells what a call is made on, by the values that the interpreter found."""

    machine: AbstractMachine

    def scope(self, function: ir.Function) -> str:
        """Return the scope of a function's members."""
        owner = function.name.rpartition("::")[0].rpartition("::")[2]
        return self._family(owner or self._lambda_scopes.get(function.key) or function.file)

    def _family(self, scope: str) -> str:
        for _ in self._bases:
            scope = self._bases.get(scope, scope)
        return scope

    @cached_property
    def _lambda_scopes(self) -> dict[tuple[str, int, str], str]:
        """The classes in whose methods lambdas of C++ stand."""
        found = dict[tuple[str, int, str], str]()
        functions = self.machine.runtime.program_functions() if self._is_cpp else ()
        for _, function in functions:
            owner = function.name.rpartition("::")[0].rpartition("::")[2]
            nodes = (n for n in ir_nodes(function.body) if owner and isinstance(n, ir.Lambda))
            found.update((node.function.key, owner) for node in nodes)
        return found

    @property
    def _is_cpp(self) -> bool:
        return self.machine.runtime.passes_by_reference

    @cached_property
    def _bases(self) -> dict[str, str]:
        """The scopes of the classes of objects, with those of their last bases."""
        found = dict[str, str]()
        pending = [one.type for one in self.machine.instances if isinstance(one, av.Instance)]
        seen = set[int]()
        while pending:
            cls = pending.pop()
            if not isinstance(cls, av.ClassValue) or id(cls) in seen:
                continue
            seen.add(id(cls))
            for base in [each for each in cls.bases if isinstance(each, av.ClassValue)][:1]:
                pending.append(base)
                if self._class_scope(cls) != self._class_scope(base):
                    found.setdefault(self._class_scope(cls), self._class_scope(base))
        return found

    def _class_scope(self, cls: av.ClassValue) -> str:
        name = cls.name.rpartition("::")[2].partition("<")[0]
        return name if self._is_cpp else cls.definition.file

    def called(self, call: ir.Call, scope: str) -> str:
        """Return the library's object or module that a call acts on; empty if it is of none.

        What only asks it does not act. A function of C++ may get a file descriptor.
        """
        name = next(callee_names(call.function), "")
        if only_reads(name):
            return ""
        if isinstance(call.function, ir.Attr):
            found = self.owner(call.function.owner, scope)
            return found or ("" if self._is_own(name) else self._held(name, scope))
        if self._is_own(name):
            return ""
        given = call.args[:1] if self._is_cpp else ()
        names = chain([name], chain.from_iterable(map(callee_names, given)))
        return next(filter(None, (self._held(each, scope) for each in names)), "")

    def _is_own(self, name: str) -> bool:
        return bool(self.machine.runtime.functions_named(name))

    def owner(self, target: ir.Expr, scope: str) -> str:
        """Return the library's object or module that something is, or is a part of."""
        while True:
            if found := self._held(next(callee_names(target), ""), scope):
                return found
            if isinstance(target, ir.Call):
                target = target.function
            elif isinstance(target, (ir.Attr, ir.Index)):
                target = target.owner
            else:
                return ""

    def _held(self, name: str, scope: str) -> str:
        """Return the library of what a variable holds, of others with its name only if all do."""
        known = self._libraries.get(name, {})
        for each in (scope, _ANYWHERE):
            if each in known:
                return known[each]
        is_own = bool(self.objects.get(name))
        return "" if is_own else next(iter(known.values()), "")

    @cached_property
    def objects(self) -> Mapping[str, frozenset[str]]:
        """The scopes of the program's objects, by the names of the variables that hold them."""
        found = defaultdict[str, set[str]](set)
        for _, name, value in self._variables():
            for one in av.options(value):
                if isinstance(one, av.Instance) and isinstance(one.type, av.ClassValue):
                    found[name].add(self._family(self._class_scope(one.type)))
        return {name: frozenset(scopes) for name, scopes in found.items()}

    @cached_property
    def _libraries(self) -> dict[str, dict[str, str]]:
        """The names of libraries' objects by those of the variables that hold them, and scope."""
        found = defaultdict[str, dict[str, str]](dict)
        for scope, name, value in self._variables():
            if library := self._library(value):
                found[name].setdefault(scope, library)
        for scope, name, made in self._locals():
            is_descriptor = self._is_cpp and f"{made}()" in DESCRIPTORS
            library = f"{made}()" if is_descriptor else next(iter(found.get(made, {}).values()), "")
            if library:
                found[name].setdefault(scope, library)
        return found

    def _variables(self) -> Iterator[tuple[str, str, av.Value]]:
        """Yield the members of objects and the variables of modules, each with its scope."""
        for one in self.machine.instances:
            if isinstance(one, av.Instance) and isinstance(one.type, av.ClassValue):
                scope = self._family(self._class_scope(one.type))
                yield from ((scope, name, value) for name, value in _named(one.fields))
        for fields in self.machine.runtime.module_variables():
            yield from ((_ANYWHERE, name, value) for name, value in _named(fields))

    def _locals(self) -> Iterator[tuple[str, str, str]]:
        """Yield the variables of functions that are made by calls, with what these begin with."""
        for _, function in self.machine.runtime.program_functions():
            for node in ir_nodes(function.body):
                if isinstance(node, (ir.Assign, ir.Declare)) and isinstance(node.value, ir.Call):
                    root = node.value.function
                    while isinstance(root, ir.Attr):
                        root = root.owner
                    made = next(callee_names(root), "")
                    targets = node.targets if isinstance(node, ir.Assign) else [ir.Name(node.name)]
                    names = chain.from_iterable(map(callee_names, targets))
                    yield from ((self.scope(function), name, made) for name in names if made)

    def _library(self, value: av.Value) -> str:
        """Return what a value is of, as its library calls it; empty if it is of the program."""
        return next(filter(None, map(self._name, av.options(value))), "")

    def _name(self, value: av.Value) -> str:
        if isinstance(value, av.ExternalSymbol):
            name = value.name
        elif isinstance(value, av.Unknown):
            name = str(value.type or value.label)
        else:
            return ""
        if self._is_cpp and name in DESCRIPTORS:
            return name
        first = re.split(r"[.:(<]", name, maxsplit=1)[0]
        is_named = "::" in name or "." in name or isinstance(value, av.ExternalSymbol)
        is_other = first in _OTHERS or _MESSAGES.search(first) or not first.isidentifier()
        return name.removesuffix("()") if is_named and not is_other else ""


def _named(fields: Mapping[Any, av.Value]) -> Iterator[tuple[str, av.Value]]:
    for name, value in fields.items():
        if isinstance(name, str):
            yield name.rpartition("::")[2], value
