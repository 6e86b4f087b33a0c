"""`<param>`: one parameter, its value written, read from a file or a command's output.

ROS wiki: roslaunch/XML/param.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.commands import CatCommand, XacroCommand, recognise_command
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import typed_argument
from rtron.sources.launch.common.expression_library import anonymous_to_wildcard
from rtron.sources.launch.common.yaml_tree import check_int_range, parse_yaml, plain_value
from rtron.sources.launch.ros1.loader_context import LoaderContext, PrivateParameter, Tag
from rtron.sources.launch.ros1.parameter_server import LoadState, join_names
from rtron.vocabulary import Evidence, ParameterValue, UnknownValue

_VALUE_ATTRIBUTES = ("value", "textfile", "binfile", "command")
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def read_param(tag: Tag, context: LoaderContext, state: LoadState) -> None:
    """Set a `<param>` of a launch or group; a private one waits for the nodes that follow.

    Raise InputError for a name or a choice of sources that roslaunch refuses.
    """
    parameter = parse_param(tag, context, state)
    if parameter.name.startswith("~"):
        context.private_parameter(parameter)
        return
    name = join_names(context.namespace, parameter.name)
    default = min(context.defaults & tag.used_arguments("value"), default="")
    argument = f"$(arg {default})" if default else ""
    state.parameters.set(
        name, parameter.value, parameter.evidence, context.uncertainty, argument=argument
    )


def parse_param(tag: Tag, context: LoaderContext, state: LoadState) -> PrivateParameter:
    """Return a `<param>` with its name as it is written; raise InputError as above."""
    name = tag.required("name").strip()
    sources = [source for source in _VALUE_ATTRIBUTES if tag.element.get(source) is not None]
    if len(sources) != 1:
        tag.fail("needs one of value, textfile, binfile and command")
    evidence = Evidence(file=tag.path, line=tag.line)
    value = _value(tag, sources[0], state)
    return PrivateParameter(
        name=name, value=value, evidence=evidence, uncertainty=context.uncertainty
    )


def convert_value(text: str, type: str, path: str = "", line: int = 0) -> ParameterValue:
    """Return a text as the type that a `<param>` names; raise ValueError or InputError."""
    if type == "yaml":
        documents = parse_yaml(text, path, line or 1).documents
        return (
            plain_value(documents[0]) if documents and documents[0] is not None else _null_error()
        )
    if type not in _CONVERSIONS:
        raise ValueError(f"'{type}' is no type: {', '.join((*_CONVERSIONS, 'yaml'))}")
    return check_int_range(_CONVERSIONS[type](text))


def _value(tag: Tag, source: str, state: LoadState) -> ParameterValue:
    try:
        text = anonymous_to_wildcard(tag.optional(source) or "")
    except UnresolvableError as error:
        state.unresolved.add(tag, str(error), package=error.package)
        return UnknownValue(str(error))
    try:
        return _read(tag, source, text, state)
    except InputError as error:
        state.unresolved.add_error(tag, error)
        return UnknownValue(str(error))
    except (UnresolvableError, ValueError) as error:
        state.unresolved.add(tag, str(error))
        return UnknownValue(str(error))


def _read(tag: Tag, source: str, text: str, state: LoadState) -> ParameterValue:
    type = (tag.element.get("type") or "auto").lower().strip()
    if source == "binfile":
        state.documents.data(text)
        return UnknownValue("binary data")
    if source == "value":
        return convert_value(text.strip(), type, tag.path, tag.line)
    content = state.documents.text(text) if source == "textfile" else _command_output(text, state)
    return convert_value(content, type, text)


def _command_output(command: str, state: LoadState) -> str:
    program = recognise_command(command)
    if isinstance(program, CatCommand):
        return state.documents.text(program.file)
    if not isinstance(program, XacroCommand):
        raise UnresolvableError(f"command is not run: {command[:200]}")
    if state.describe is None:
        raise UnresolvableError(f"xacro is not evaluated: {program.file}")
    description = state.describe(Path(program.file).absolute(), program.mappings)
    if isinstance(description, UnknownValue):
        raise UnresolvableError(description.why)
    return description


def _boolean(text: str) -> bool:
    normalised = text.lower().strip()
    if normalised not in _BOOLEANS:
        raise ValueError(f"'{text}' is neither true nor false")
    return _BOOLEANS[normalised]


def _null_error() -> ParameterValue:
    raise ValueError("a parameter cannot be null")


_CONVERSIONS: Mapping[str, Callable[[str], ParameterValue]] = {
    "auto": typed_argument,
    "str": str,
    "string": str,
    "int": int,
    "double": float,
    "bool": _boolean,
    "boolean": _boolean,
}
