"""The JSON Schema of the plan file, from the same form that the reader follows."""

from enum import Enum
from typing import Any

from rtron.planning.durations import UNITS
from rtron.planning.form import NOUNS, Key, keys
from rtron.vocabulary import PLAN_SCHEMA, Plan

_DURATION = {
    "anyOf": [
        {"type": "number", "minimum": 0},
        {"type": "string", "pattern": rf"^[0-9]+(\.[0-9]+)? ?({'|'.join(UNITS)})?$"},
    ],
    "description": "seconds, or a number with a unit",
}


def plan_json_schema() -> dict[str, Any]:
    """Return the JSON Schema of `rtron.yaml`, for editors and other programs."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": PLAN_SCHEMA,
        **_noun(Plan),
        "$defs": {noun.__name__: _noun(noun) for noun in NOUNS if noun is not Plan},
    }


def _noun(noun: type) -> dict[str, Any]:
    known = keys(noun)
    return {
        "type": "object",
        "description": " ".join((noun.__doc__ or "").split()),
        "properties": {name: _property(key) for name, key in known.items()},
        "required": [name for name, key in known.items() if key.required],
        "additionalProperties": False,
    }


def _property(key: Key) -> dict[str, Any]:
    one = _item(key)
    if key.many:
        return {"type": "array", "items": one}
    if key.optional:
        one = {"anyOf": [one, {"type": "null"}]}
    return one


def _item(key: Key) -> dict[str, Any]:
    if key.item in NOUNS:
        return {"$ref": f"#/$defs/{key.item.__name__}"}
    if key.duration:
        return _DURATION
    if key.item is bool:
        return {"type": "boolean"}
    if key.item is int:
        least, greatest = key.range
        return {"type": "integer", "minimum": least, "maximum": greatest}
    if issubclass(key.item, Enum):
        return {"enum": [str(word.value) for word in key.item]}
    text = key.text
    return {
        "type": "string",
        "pattern": f"^{text.pattern}$",
        "maxLength": text.longest,
        "description": text.words,
    }
