"""Substitutions of a Python launch file as texts that are evaluated later, by launch's rules."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Choice,
    Foreign,
    Hole,
    Instance,
    Known,
    ListValue,
    Text,
    Value,
    concat,
    options,
    plain,
    spelled,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.library_models.launch.constructor_calls import ALL, call_name, given
from rtron.sources.code.library_models.launch.signatures import MODULES
from rtron.sources.launch.ros2.context_view import View
from rtron.sources.launch.ros2.substitutions.substitution import MAX_PRINTED
from rtron.sources.launch.ros2.substitutions.template import Call, Deferred, Pieces, hole, parts

Fields: TypeAlias = Mapping[str, Value]
Run: TypeAlias = Callable[[View], str]
MAX_DEPTH = 24


@dataclass(frozen=True, slots=True)
class Texts:
    """Turns values into texts; `context` makes what a function of the file gets as its context.

    `count` is called for each part, and ends what has too many.
    `files` are the substitutions that make a file: each returns what makes it.
    """

    machine: Machine
    context: Callable[[View], Instance]
    files: Mapping[str, Callable[["Texts", Fields], Run]]
    count: Callable[[], None]

    def pieces(self, value: Value | None, depth: int = 0) -> Pieces:
        """Return a text: a string, a substitution, or a list of both."""
        self.count()
        if value is None or value == NONE or depth > MAX_DEPTH:
            return ()
        if isinstance(value, Known):
            text = plain(value.value)
            return (text if len(text) <= MAX_PRINTED else hole("a long text"),)
        if isinstance(value, Text):
            return ("".join(p if isinstance(p, str) else hole(p.why) for p in value.parts),)
        if isinstance(value, ListValue):
            found = [piece for item in value.items for piece in self.pieces(item, depth + 1)]
            return (*found, hole("more")) if value.open else tuple(found)
        if isinstance(value, Instance):
            return self._of_instance(value, depth)
        return (hole(_called(value)),)

    def _of_instance(self, value: Instance, depth: int) -> Pieces:
        name, fields = call_name(value), given(value)
        if name in self.files:
            return (self._deferred(self.files[name](self, fields)),)
        if name in _CALLS:
            return (_CALLS[name](self, fields, value, depth + 1),)
        if name in _TEXT:
            return self.pieces(fields.get(_TEXT[name]), depth + 1)
        method = self.machine.world.attribute(value, "perform", ())
        if method is not None and not name:
            return (self._deferred(lambda view: self._performed(method, view)),)
        return (hole(name or "object"),)

    def _deferred(self, run: Run) -> Deferred:
        return Deferred(lambda view: run(view) if isinstance(view, View) else hole("made"))

    def _performed(self, method: Value, view: View) -> str:
        """Return what a substitution of the launch file's own makes."""
        arguments = Arguments(values=(self.context(view),), frame=Frame(file=""))
        return view.perform(self.pieces(dispatch(self.machine, method, arguments)))


def value_of(text: str) -> Value:
    """Return an evaluated text as the interpreter's value."""
    return concat([Hole(part) if is_hole else Known(part) for part, is_hole in parts(text)])


def plain_text(value: Value | None) -> str:
    """Return a text that holds no substitutions."""
    return spelled(value) if isinstance(value, (Known, Text)) else ""


def says_no(value: Value | None) -> bool:
    """Tell whether a value that is true by default is not."""
    return value is not None and truth(value) is False


def _called(value: Value) -> str:
    if isinstance(value, Choice):
        return " or ".join(spelled(option) for option in options(value)[:4])
    return value.name if isinstance(value, Foreign) else getattr(value, "why", "?")


def _call(name: str, *keys: str) -> Callable[[Texts, Fields, Instance, int], Call]:
    """Return what makes a call whose arguments are parameters; those at the end may be missing."""

    def made(texts: Texts, fields: Fields, _: Instance, depth: int) -> Call:
        words = [fields[key] for key in keys if fields.get(key, NONE) != NONE]
        return Call(name, tuple(texts.pieces(word, depth) for word in words))

    return made


def _items(name: str, key: str) -> Callable[[Texts, Fields, Instance, int], Call]:
    """Return what makes a call whose arguments are a list's items."""

    def made(texts: Texts, fields: Fields, value: Instance, depth: int) -> Call:
        listed = value.fields[ALL] if key == ALL else fields.get(key, NONE)
        before = (texts.pieces(fields.get("delimiter")),) if name == "string-join" else ()
        items, certain = items_of(listed) if isinstance(listed, ListValue) else ((listed,), True)
        found = tuple(texts.pieces(item, depth) for item in items)
        return Call(name, (*before, *found, *(() if certain else ((hole("more"),),))))

    return made


def _as_bool(texts: Texts, fields: Fields, _: Instance, depth: int) -> Call:
    named = Call("var", (texts.pieces(fields.get("name"), depth),))
    return Call("as-bool", ((named,),))


_TEXT = {
    "TextSubstitution": "text",
    "PathSubstitution": "path",
    "ParameterFile": "param_file",
    "ParameterValue": "value",
    "IfCondition": "predicate_expression",
    **dict.fromkeys(MODULES["launch.launch_description_sources"], "location"),
}
_CALLS: Mapping[str, Callable[[Texts, Fields, Instance, int], Call]] = {
    "LaunchConfiguration": _call("var", "variable_name", "default"),
    "EnvironmentVariable": _call("env", "name", "default_value"),
    "PathJoinSubstitution": _items("path-join", "substitutions"),
    "StringJoinSubstitution": _items("string-join", "substitutions"),
    "PythonExpression": _call("eval", "expression"),
    "Command": _call("command", "command"),
    "FileContent": _call("file-content", "path"),
    "FindExecutable": _call("find-exec", "name"),
    "ForEachVar": _call("for-var", "name", "default_value"),
    "ForLoopIndex": _call("index", "name"),
    "Parameter": _call("param", "name", "default"),
    "ThisLaunchFile": _call("filename"),
    "ThisLaunchFileDir": _call("dirname"),
    "LaunchLogDir": _call("log_dir"),
    "LocalSubstitution": _call("local", "expression"),
    "AnonName": _call("anon", "name"),
    "NotSubstitution": _call("not", "value"),
    "AndSubstitution": _call("and", "left", "right"),
    "OrSubstitution": _call("or", "left", "right"),
    "AnySubstitution": _items("any", ALL),
    "AllSubstitution": _items("all", ALL),
    "EqualsSubstitution": _call("equals", "left", "right"),
    "NotEqualsSubstitution": _call("not-equals", "left", "right"),
    "IfElseSubstitution": _call("if", "condition", "if_value", "else_value"),
    "FindPackageShare": _call("find-pkg-share", "package"),
    "FindPackagePrefix": _call("find-pkg-prefix", "package"),
    "FindPackage": _call("find-pkg-prefix", "package"),
    "ExecutableInPackage": _call("exec-in-pkg", "executable", "package"),
    "UnlessCondition": _call("not", "predicate_expression"),
    "LaunchConfigurationEquals": _call(
        "config-equals", "launch_configuration_name", "expected_value"
    ),
    "LaunchConfigAsBool": _as_bool,
}
