"""Substitutions of a Python launch file as texts that are evaluated later, by launch's rules."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.abstract_values.value_types import plain
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.library_models.launch.constructor_calls import (
    ARGUMENTS_FIELD,
    constructor_arguments,
    launch_class_name,
)
from rtron.sources.code.library_models.launch.signatures import CLASSES_BY_MODULE
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.substitutions.substitution import MAX_COMMAND_OUTPUT
from rtron.sources.launch.ros2.substitutions.template import (
    DeferredSubstitution,
    SubstitutionCall,
    Template,
    placeholder,
    split_placeholders,
)

Fields: TypeAlias = Mapping[str, av.Value]
PerformSubstitution: TypeAlias = Callable[[ContextView], str]
_CallBuilder: TypeAlias = (
    "Callable[[SubstitutionTranslator, Fields, av.Instance, int], SubstitutionCall]"
)
MAX_DEPTH = 24


@dataclass(frozen=True, slots=True)
class SubstitutionTranslator:
    """Turns values into texts; `context` makes what a function of the file gets as its context.

    `count` is called for each part, and ends what has too many.
    `file_substitutions` are the substitutions that make a file: each returns what makes it.
    """

    machine: AbstractMachine
    context: Callable[[ContextView], av.Instance]
    file_substitutions: Mapping[
        str, Callable[["SubstitutionTranslator", Fields], PerformSubstitution]
    ]
    count: Callable[[], None]

    def template(self, value: av.Value | None, depth: int = 0) -> Template:
        """Return a text: a string, a substitution, or a list of both."""
        self.count()
        if value is None or value == av.NONE or depth > MAX_DEPTH:
            return ()
        if isinstance(value, av.Scalar):
            text = plain(value.value)
            return (text if len(text) <= MAX_COMMAND_OUTPUT else placeholder("a long text"),)
        if isinstance(value, av.PartialText):
            return (
                "".join(p if isinstance(p, str) else placeholder(p.label) for p in value.parts),
            )
        if isinstance(value, av.ListValue):
            parts_of_list = [
                piece for item in value.items for piece in self.template(item, depth + 1)
            ]
            return (*parts_of_list, placeholder("more")) if value.open else tuple(parts_of_list)
        if isinstance(value, av.Instance):
            return self._template_of_instance(value, depth)
        return (placeholder(_placeholder_name(value)),)

    def _template_of_instance(self, value: av.Instance, depth: int) -> Template:
        name, fields = launch_class_name(value), constructor_arguments(value)
        if name in self.file_substitutions:
            return (self._deferred_substitution(self.file_substitutions[name](self, fields)),)
        if name in _CALL_BUILDERS:
            return (_CALL_BUILDERS[name](self, fields, value, depth + 1),)
        if name in _TEXT_FIELDS:
            return self.template(fields.get(_TEXT_FIELDS[name]), depth + 1)
        method = self.machine.runtime.attribute(value, "perform", ())
        if method is not None and not name:
            return (self._deferred_substitution(lambda view: self._perform_custom(method, view)),)
        return (placeholder(name or "object"),)

    def _deferred_substitution(self, run: PerformSubstitution) -> DeferredSubstitution:
        return DeferredSubstitution(
            lambda view: run(view) if isinstance(view, ContextView) else placeholder("made")
        )

    def _perform_custom(self, method: av.Value, view: ContextView) -> str:
        """Return what a substitution of the launch file's own makes."""
        arguments = Arguments(values=(self.context(view),), frame=StackFrame(file=""))
        return view.perform(self.template(dispatch(self.machine, method, arguments)))


def value_of(text: str) -> av.Value:
    """Return an evaluated text as the interpreter's value."""
    return av.concat(
        [
            av.Unknown(part) if is_hole else av.Scalar(part)
            for part, is_hole in split_placeholders(text)
        ]
    )


def plain_text(value: av.Value | None) -> str:
    """Return a text that holds no substitutions."""
    return av.text_with_holes(value) if isinstance(value, (av.Scalar, av.PartialText)) else ""


def is_false(value: av.Value | None) -> bool:
    """Tell whether a value that is true by default is not."""
    return value is not None and av.truth(value) is False


def _placeholder_name(value: av.Value) -> str:
    if isinstance(value, av.Choice):
        return " or ".join(av.text_with_holes(option) for option in av.options(value)[:4])
    if isinstance(value, av.ExternalSymbol):
        return value.name
    return value.label if isinstance(value, av.Unknown) else "?"


def _call_builder(name: str, *keys: str) -> _CallBuilder:
    """Return what makes a call whose arguments are parameters; those at the end may be missing."""

    def made(
        translator: SubstitutionTranslator, fields: Fields, _: av.Instance, depth: int
    ) -> SubstitutionCall:
        arguments = [fields[key] for key in keys if fields.get(key, av.NONE) != av.NONE]
        return SubstitutionCall(
            name, tuple(translator.template(argument, depth) for argument in arguments)
        )

    return made


def _list_call_builder(name: str, key: str) -> _CallBuilder:
    """Return what makes a call whose arguments are a list's items."""

    def made(
        translator: SubstitutionTranslator, fields: Fields, value: av.Instance, depth: int
    ) -> SubstitutionCall:
        listed = (
            value.fields[ARGUMENTS_FIELD] if key == ARGUMENTS_FIELD else fields.get(key, av.NONE)
        )
        before = (translator.template(fields.get("delimiter")),) if name == "string-join" else ()
        items, certain = (
            av.items_of(listed) if isinstance(listed, av.ListValue) else ((listed,), True)
        )
        templates = tuple(translator.template(item, depth) for item in items)
        return SubstitutionCall(
            name, (*before, *templates, *(() if certain else ((placeholder("more"),),)))
        )

    return made


def _as_bool(
    translator: SubstitutionTranslator, fields: Fields, _: av.Instance, depth: int
) -> SubstitutionCall:
    named = SubstitutionCall("var", (translator.template(fields.get("name"), depth),))
    return SubstitutionCall("as-bool", ((named,),))


def _not_equal(
    translator: SubstitutionTranslator, fields: Fields, value: av.Instance, depth: int
) -> SubstitutionCall:
    return SubstitutionCall("not", ((_CONFIG_EQUALS(translator, fields, value, depth),),))


_CONFIG_EQUALS = _call_builder("config-equals", "launch_configuration_name", "expected_value")
_CONDITIONS: Mapping[str, _CallBuilder] = {
    "UnlessCondition": _call_builder("not", "predicate_expression"),
    "LaunchConfigurationEquals": _CONFIG_EQUALS,
    "LaunchConfigurationNotEquals": _not_equal,
}
_TEXT_FIELDS = {
    "TextSubstitution": "text",
    "PathSubstitution": "path",
    "ParameterFile": "param_file",
    "ParameterValue": "value",
    "IfCondition": "predicate_expression",
    **dict.fromkeys(CLASSES_BY_MODULE["launch.launch_description_sources"], "location"),
}
_CALL_BUILDERS: Mapping[str, _CallBuilder] = {
    "LaunchConfiguration": _call_builder("var", "variable_name", "default"),
    "EnvironmentVariable": _call_builder("env", "name", "default_value"),
    "PathJoinSubstitution": _list_call_builder("path-join", "substitutions"),
    "StringJoinSubstitution": _list_call_builder("string-join", "substitutions"),
    "PythonExpression": _call_builder("eval", "expression"),
    "Command": _call_builder("command", "command"),
    "FileContent": _call_builder("file-content", "path"),
    "FindExecutable": _call_builder("find-exec", "name"),
    "ForEachVar": _call_builder("for-var", "name", "default_value"),
    "ForLoopIndex": _call_builder("index", "name"),
    "Parameter": _call_builder("param", "name", "default"),
    "ThisLaunchFile": _call_builder("filename"),
    "ThisLaunchFileDir": _call_builder("dirname"),
    "LaunchLogDir": _call_builder("log_dir"),
    "LocalSubstitution": _call_builder("local", "expression"),
    "AnonName": _call_builder("anon", "name"),
    "NotSubstitution": _call_builder("not", "value"),
    "AndSubstitution": _call_builder("and", "left", "right"),
    "OrSubstitution": _call_builder("or", "left", "right"),
    "AnySubstitution": _list_call_builder("any", ARGUMENTS_FIELD),
    "AllSubstitution": _list_call_builder("all", ARGUMENTS_FIELD),
    "EqualsSubstitution": _call_builder("equals", "left", "right"),
    "NotEqualsSubstitution": _call_builder("not-equals", "left", "right"),
    "IfElseSubstitution": _call_builder("if", "condition", "if_value", "else_value"),
    "FindPackageShare": _call_builder("find-pkg-share", "package"),
    "FindPackagePrefix": _call_builder("find-pkg-prefix", "package"),
    "FindPackage": _call_builder("find-pkg-prefix", "package"),
    "ExecutableInPackage": _call_builder("exec-in-pkg", "executable", "package"),
    "LaunchConfigAsBool": _as_bool,
    **_CONDITIONS,
}
