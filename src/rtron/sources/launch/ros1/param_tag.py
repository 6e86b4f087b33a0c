"""`<param>`: one parameter, its value written, read from a file or a command's output.

ROS wiki: roslaunch/XML/param.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.commands import Cat, Xacro, recognise
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import typed
from rtron.sources.launch.common.yaml_scalars import in_range
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain
from rtron.sources.launch.ros1.load_state import Reading
from rtron.sources.launch.ros1.loader_context import PrivateParameter, Scope
from rtron.sources.launch.ros1.parameter_server import join_names
from rtron.sources.launch.ros1.substitution_args import as_pattern
from rtron.sources.launch.ros1.tag import Tag
from rtron.vocabulary import Evidence, ParameterValue, UnknownValue

_SOURCES = ("value", "textfile", "binfile", "command")
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


def read_param(tag: Tag, scope: Scope, reading: Reading) -> None:
    """Set a `<param>` of a launch or group; a private one waits for the nodes that follow.

    Raise InputError for a name or a choice of sources that roslaunch refuses.
    """
    found = read_private_param(tag, scope, reading)
    if found.name.startswith("~"):
        scope.private_parameter(found)
        return
    name = join_names(scope.namespace, found.name)
    reading.parameters.set(name, found.value, found.evidence, scope.doubt)


def read_private_param(tag: Tag, scope: Scope, reading: Reading) -> PrivateParameter:
    """Return a `<param>` with its name as it is written; raise InputError as above."""
    name = tag.required("name").strip()
    given = [source for source in _SOURCES if tag.element.get(source) is not None]
    if len(given) != 1:
        tag.fault("needs one of value, textfile, binfile and command")
    evidence = Evidence(file=tag.path, line=tag.line)
    value = _value(tag, given[0], reading)
    return PrivateParameter(name=name, value=value, evidence=evidence, doubt=scope.doubt)


def converted(text: str, type: str, path: str = "", line: int = 0) -> ParameterValue:
    """Return a text as the type that a `<param>` names; raise ValueError or InputError."""
    if type == "yaml":
        documents = parse_yaml(text, path, line or 1).documents
        return plain(documents[0]) if documents and documents[0] is not None else _no_value()
    if type not in _CONVERSIONS:
        raise ValueError(f"'{type}' is no type: {', '.join((*_CONVERSIONS, 'yaml'))}")
    return in_range(_CONVERSIONS[type](text))


def _value(tag: Tag, source: str, reading: Reading) -> ParameterValue:
    try:
        text = as_pattern(tag.optional(source) or "")
    except UnresolvableError as error:
        reading.notes.add(tag, str(error))
        return UnknownValue(str(error))
    try:
        return _read(tag, source, text, reading)
    except InputError as error:
        reading.notes.add_error(tag, error)
        return UnknownValue(str(error))
    except (UnresolvableError, ValueError) as error:
        reading.notes.add(tag, str(error))
        return UnknownValue(str(error))


def _read(tag: Tag, source: str, text: str, reading: Reading) -> ParameterValue:
    type = (tag.element.get("type") or "auto").lower().strip()
    if source == "binfile":
        reading.documents.data(text)
        return UnknownValue("binary data")
    if source == "value":
        return converted(text.strip(), type, tag.path, tag.line)
    content = reading.documents.text(text) if source == "textfile" else _output(text, reading)
    return converted(content, type, text)


def _output(command: str, reading: Reading) -> str:
    run = recognise(command)
    if isinstance(run, Cat):
        return reading.documents.text(run.file)
    if not isinstance(run, Xacro):
        raise UnresolvableError(f"command is not run: {command[:200]}")
    if reading.describe is None:
        raise UnresolvableError(f"xacro is not evaluated: {run.file}")
    description = reading.describe(Path(run.file).absolute(), run.mappings)
    if isinstance(description, UnknownValue):
        raise UnresolvableError(description.why)
    return description


def _boolean(text: str) -> bool:
    word = text.lower().strip()
    if word not in _BOOLEANS:
        raise ValueError(f"'{text}' is neither true nor false")
    return _BOOLEANS[word]


def _no_value() -> ParameterValue:
    raise ValueError("a parameter cannot be null")


_CONVERSIONS: Mapping[str, Callable[[str], ParameterValue]] = {
    "auto": typed,
    "str": str,
    "string": str,
    "int": int,
    "double": float,
    "bool": _boolean,
    "boolean": _boolean,
}
