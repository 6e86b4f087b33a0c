"""The JSON Schema of the plan file, from the same form that the reader follows."""

from enum import Enum
from typing import Any

from rtron.planning.plan_file.fields import PLAN_TYPES, PlanField, plan_fields
from rtron.planning.plan_file.quantities import UNITS, Quantity
from rtron.vocabulary import PLAN_SCHEMA, SECOND, Plan

PLAN_SCHEMA_URL = "https://raw.githubusercontent.com/rtron/rtron/main/schemas/rtron.plan.json"
"""Where editors find the schema: the repository's `schemas/`, as pyproject.toml has its address."""


def plan_json_schema() -> dict[str, Any]:
    """Return the JSON Schema of `rtron.yaml`, for editors and other programs."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": PLAN_SCHEMA_URL,
        "title": PLAN_SCHEMA,
        **_plan_type(Plan),
        "$defs": {
            plan_type.__name__: _plan_type(plan_type)
            for plan_type in PLAN_TYPES
            if plan_type is not Plan
        },
    }


def _plan_type(plan_type: type) -> dict[str, Any]:
    known = plan_fields(plan_type)
    return {
        "type": "object",
        "description": " ".join((plan_type.__doc__ or "").split()),
        "properties": {name: _property(key) for name, key in known.items()},
        "required": [name for name, key in known.items() if key.is_required],
        "additionalProperties": False,
    }


def _property(key: PlanField) -> dict[str, Any]:
    one = _item(key)
    if key.is_list:
        return {"type": "array", "items": one} | ({"minItems": 1} if key.if_empty else {})
    if key.is_optional:
        one = {"anyOf": [one, {"type": "null"}]}
    return one


def _item(key: PlanField) -> dict[str, Any]:
    if key.item_type in PLAN_TYPES:
        return {"$ref": f"#/$defs/{key.item_type.__name__}"}
    if key.item_type is bool:
        return {"type": "boolean"}
    if key.item_type in (int, float):
        return _number(key)
    if issubclass(key.item_type, Enum):
        return {"enum": [str(word.value) for word in key.item_type]}
    return {
        "type": "string",
        "pattern": f"^{key.text.pattern}$",
        "maxLength": key.text.max_length,
        "description": key.text.description,
    }


def _number(key: PlanField) -> dict[str, Any]:
    if key.is_duration:
        return _duration(key.range)
    if key.quantity:
        return _quantity(key.quantity)
    least, greatest = key.range
    return {"type": "integer", "minimum": least, "maximum": greatest}


def _duration(limits: tuple[int, int]) -> dict[str, Any]:
    least, greatest = (bound / SECOND for bound in limits)
    pattern = rf"^[0-9]+(\.[0-9]+)? ?({'|'.join(UNITS)})?$"
    return {
        "anyOf": [
            {"type": "number", "minimum": least, "maximum": greatest},
            {"type": "string", "pattern": pattern},
        ],
        "description": "seconds, or a number with a unit",
    }


def _quantity(quantity: Quantity) -> dict[str, Any]:
    return {
        "anyOf": [
            {"type": "number", "minimum": quantity.minimum, "maximum": quantity.maximum},
            {"type": "string", "pattern": f"^{quantity.pattern}$"},
        ],
        "description": f"a {quantity.description} in {quantity.unit}, or a number with a unit",
    }
