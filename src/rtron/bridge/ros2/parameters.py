"""Parameters of ROS 2 as JSON: those of a node are read and written by services of that node.

A parameter is `/node:name`, as rosapi has it (rcl_interfaces: Parameter, ParameterType).
"""

import json
from typing import Any

from rtron.bridge.protocol.effects import ParameterVerb, RequestParameter
from rtron.bridge.protocol.frames import Document
from rtron.errors import SourceError

_NOT_SET = 0
_FIELDS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
_TYPES: tuple[tuple[type, int], ...] = ((bool, 1), (int, 2), (float, 3), (str, 4))
"""The types of single values; bool is before int, which it is one of."""
_ARRAYS = 5
"""How much the number of a list's type is above that of its values."""


def parameter_call(request: RequestParameter) -> tuple[str, str, Document]:
    """Return the service, its type and its arguments that read or write a parameter.

    SourceError if it has no node, or a value that no parameter has.
    """
    node, _, name = request.name.partition(":")
    if not name:
        raise SourceError(f"a parameter of ROS 2 is /node:name, not {request.name}")
    if request.verb in (ParameterVerb.GET, ParameterVerb.HAS):
        return f"{node}/get_parameters", "rcl_interfaces/GetParameters", {"names": [name]}
    is_set = request.verb is ParameterVerb.SET
    value = parameter_value(request.value) if is_set else {"type": _NOT_SET}
    arguments = {"parameters": [{"name": name, "value": value}]}
    return f"{node}/set_parameters", "rcl_interfaces/SetParameters", arguments


def parameter_answer(request: RequestParameter, response: Document) -> Document:
    """Return what rosapi answers; SourceError if the node has said no."""
    if request.verb in (ParameterVerb.GET, ParameterVerb.HAS):
        found = (response.get("values") or [{}])[0]
        field = _FIELDS.get(found.get("type", _NOT_SET))
        if request.verb is ParameterVerb.HAS:
            return {"exists": field is not None}
        if field is None:
            raise SourceError(f"there is no parameter {request.name}")
        return {"value": json.dumps(found[field]), "successful": True}
    result = (response.get("results") or [{}])[0]
    if not result.get("successful"):
        reason = str(result.get("reason") or "its node gives no reason")
        raise SourceError(f"{request.name} is not set: {reason}")
    return {"successful": True}


def parameter_value(value: Any) -> Document:  # noqa: ANN401 - any JSON
    """Return a value as a parameter has it; SourceError if none has it."""
    if isinstance(value, list):
        kinds = {_type_of(each) for each in value}
        if kinds == {2, 3}:
            kinds, value = {3}, [float(each) for each in value]
        if len(kinds) == 1 and None not in kinds:
            kind = int(kinds.pop() or 0) + _ARRAYS
            return {"type": kind, _FIELDS[kind]: value}
    elif (single := _type_of(value)) is not None:
        return {"type": single, _FIELDS[single]: value}
    raise SourceError("a parameter is a number, a text, true or false, or a list of one of these")


def _type_of(value: object) -> int | None:
    return next((number for kind, number in _TYPES if isinstance(value, kind)), None)
