"""A plan as JSON, and its digest."""

import json
from hashlib import sha256
from typing import Any

from pydantic import TypeAdapter

from rtron.vocabulary import Plan

_PLAN: TypeAdapter[Plan] = TypeAdapter(Plan)


def plan_json(plan: Plan) -> dict[str, Any]:
    """Return a plan as JSON: the nouns of the vocabulary, durations in ns."""
    document: dict[str, Any] = _PLAN.dump_python(plan, mode="json")
    return document


def parse_plan(document: dict[str, Any]) -> Plan:
    """Return the plan of a JSON document that `plan_json` made."""
    return _PLAN.validate_python(document)


def plan_digest(document: dict[str, Any]) -> str:
    """Return what tells one plan's JSON from another."""
    return sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()
