"""The JSON Schema of the plan file, from the same form that the reader follows."""

from enum import Enum
from typing import Any

from rtron.planning.plan_file.durations import UNITS
from rtron.planning.plan_file.fields import NOUNS, Key, keys
from rtron.planning.plan_file.quantities import Quantity
from rtron.vocabulary import PLAN_SCHEMA, SECOND, Plan


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
    if key.item is bool:
        return {"type": "boolean"}
    if key.item in (int, float):
        return _number(key)
    if issubclass(key.item, Enum):
        return {"enum": [str(word.value) for word in key.item]}
    return {
        "type": "string",
        "pattern": f"^{key.text.pattern}$",
        "maxLength": key.text.longest,
        "description": key.text.words,
    }


def _number(key: Key) -> dict[str, Any]:
    if key.duration:
        return _duration(key.range)
    if key.quantity:
        return _quantity(key.quantity)
    least, greatest = key.range
    return {"type": "integer", "minimum": least, "maximum": greatest}


def _duration(limits: tuple[int, int]) -> dict[str, Any]:
    least, greatest = (bound / SECOND for bound in limits)
    written = rf"^[0-9]+(\.[0-9]+)? ?({'|'.join(UNITS)})?$"
    return {
        "anyOf": [
            {"type": "number", "minimum": least, "maximum": greatest},
            {"type": "string", "pattern": written},
        ],
        "description": "seconds, or a number with a unit",
    }


def _quantity(quantity: Quantity) -> dict[str, Any]:
    return {
        "anyOf": [
            {"type": "number", "minimum": quantity.least, "maximum": quantity.greatest},
            {"type": "string", "pattern": f"^{quantity.pattern}$"},
        ],
        "description": f"a {quantity.words} in {quantity.unit}, or a number with a unit",
    }
