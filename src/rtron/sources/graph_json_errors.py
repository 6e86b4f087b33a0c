"""What is wrong with a graph file, said to the person who has to mend it."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from rtron.errors import InputError
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
    Unresolved,
)

_Fault = Mapping[str, Any]
_SHOWN = 60
_TOP_LEVEL = ("schema", *(field.name for field in fields(InteractionGraph) if field.init))
_KEYS: Mapping[str, tuple[str, ...]] = {
    key: tuple(field.name for field in fields(noun))
    for key, noun in {
        "nodes": Node,
        "topics": Topic,
        "endpoints": Endpoint,
        "services": Service,
        "actions": Action,
        "unresolved": Unresolved,
        "evidence": Evidence,
        "qos": QoS,
    }.items()
}


def fault_in(error: ValidationError, path: str) -> InputError:
    """Return the fault of a graph file that tells most, as an InputError."""
    fault = min(error.errors(include_url=False), key=_rank)
    if fault["type"] == "json_invalid":
        return _not_json(fault, path)
    place = _place(fault["loc"])
    return InputError(f"{place}: {_message(fault)}", path=path, help=_help(fault))


def _rank(fault: _Fault) -> int:
    """Put a wrong schema first, then a misspelt key before the key that is missing for it."""
    if fault["loc"] == ("schema",):
        return 0
    return 1 if fault["type"] == "unexpected_keyword_argument" else 2


def _not_json(fault: _Fault, path: str) -> InputError:
    reason = fault["ctx"]["error"]
    line = re.search(r"line (\d+)", reason)
    return InputError(
        f"not JSON: {reason}",
        path=path,
        line=int(line[1]) if line else 0,
        help="the graph is one JSON object in UTF-8; was the file cut off?",
    )


def _place(location: Sequence[str | int]) -> str:
    """Return a JSON path such as `endpoints[3].direction`."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return "".join(parts).removeprefix(".") or "the document"


def _message(fault: _Fault) -> str:
    if fault["type"] == "missing":
        return "is missing"
    if fault["type"] == "unexpected_keyword_argument":
        return "is not a key of the schema"
    wanted = fault["msg"].removeprefix("Input should be ")
    return f"must be {wanted}, not {_shown(fault['input'])}"


def _shown(value: object) -> str:
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    text = repr(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "…"


def _help(fault: _Fault) -> str:
    location = fault["loc"]
    if location == ("schema",):
        return f'an interaction graph begins {{"schema": "{GRAPH_SCHEMA}", …}}'
    if fault["type"] == "unexpected_keyword_argument":
        return _suggestion(str(location[-1]), _keys_at(location[:-1]))
    if "expected" in fault.get("ctx", {}):
        words = re.findall(r"'([^']*)'", fault["ctx"]["expected"])
        return _suggestion(str(fault["input"]), words)
    return "correct the value, or leave the key out if it is optional"


def _keys_at(location: Sequence[str | int]) -> Sequence[str]:
    """Return the keys of the object at a place: those of the innermost list or object named."""
    named = [part for part in location if isinstance(part, str)]
    return _KEYS[named[-1]] if named else _TOP_LEVEL


def _suggestion(word: str, words: Sequence[str]) -> str:
    near = get_close_matches(word, words, n=1)
    known = "it can be " + ", ".join(words)
    return f"did you mean `{near[0]}`? {known}" if near else known
