"""What is wrong with a graph file, said to the person who has to mend it."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from rtron.errors import InputError, plain_reason
from rtron.vocabulary import (
    GRAPH_SCHEMA,
    Action,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    QoS,
    Service,
    Topic,
    UnresolvedItem,
)

_ErrorDetails = Mapping[str, Any]
_MAX_SHOWN = 60
_TOP_LEVEL = ("schema", *(field.name for field in fields(InteractionGraph) if field.init))
_KEYS: Mapping[str, tuple[str, ...]] = {
    key: tuple(field.name for field in fields(noun))
    for key, noun in {
        "nodes": Node,
        "topics": Topic,
        "endpoints": Endpoint,
        "services": Service,
        "actions": Action,
        "unresolved": UnresolvedItem,
        "evidence": Evidence,
        "qos": QoS,
    }.items()
}


def graph_file_error(error: ValidationError, path: str) -> InputError:
    """Return the fault of a graph file that tells most, as an InputError."""
    details = min(error.errors(include_url=False), key=_rank)
    if details["type"] == "json_invalid":
        return _syntax_error(details, path)
    json_path = _json_path(details["loc"])
    return InputError(f"{json_path}: {_message(details)}", path=path, help=_help(details))


def _rank(details: _ErrorDetails) -> int:
    """Put a wrong schema first, then a misspelt key before the key that is missing for it."""
    if details["loc"] == ("schema",):
        return 0
    return 1 if details["type"] == "unexpected_keyword_argument" else 2


def _syntax_error(details: _ErrorDetails, path: str) -> InputError:
    reason = details["ctx"]["error"]
    line = re.search(r"line (\d+)", reason)
    return InputError(
        f"not JSON: {reason}",
        path=path,
        line=int(line[1]) if line else 0,
        help="the graph is one JSON object in UTF-8; was the file cut off?",
    )


def _json_path(location: Sequence[str | int]) -> str:
    """Return a JSON path such as `endpoints[3].direction`."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return "".join(parts).removeprefix(".") or "the document"


def _message(details: _ErrorDetails) -> str:
    if details["type"] == "missing":
        return "is missing"
    if details["type"] == "unexpected_keyword_argument":
        return "is not a key of the schema"
    expected = plain_reason(details["msg"]).removeprefix("Input should be ")
    return f"must be {expected}, not {_value_text(details['input'])}"


def _value_text(value: object) -> str:
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    text = repr(value)
    return text if len(text) <= _MAX_SHOWN else text[:_MAX_SHOWN] + "…"


def _help(details: _ErrorDetails) -> str:
    location = details["loc"]
    if location == ("schema",):
        return f'an interaction graph begins {{"schema": "{GRAPH_SCHEMA}", …}}'
    if details["type"] == "unexpected_keyword_argument":
        return _suggestion(str(location[-1]), _keys_at(location[:-1]))
    if "expected" in details.get("ctx", {}):
        choices = re.findall(r"'([^']*)'", details["ctx"]["expected"])
        return _suggestion(str(details["input"]), choices)
    return "correct the value, or leave the key out if it is optional"


def _keys_at(location: Sequence[str | int]) -> Sequence[str]:
    """Return the keys of the object at a place: those of the innermost list or object named."""
    keys = [part for part in location if isinstance(part, str)]
    return _KEYS[keys[-1]] if keys else _TOP_LEVEL


def _suggestion(value: str, choices: Sequence[str]) -> str:
    matches = get_close_matches(value, choices, n=1)
    choices_text = "it can be " + ", ".join(choices)
    return f"did you mean `{matches[0]}`? {choices_text}" if matches else choices_text
