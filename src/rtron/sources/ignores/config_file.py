"""`rtron.toml`: the findings that a project ignores, each with the reason.

[[ignore]]
rule = "several_publishers"
topic = "/cmd_vel"            # optional, a pattern as the shell's; without it all topics
reason = "a switch on the joystick parts the two"
"""

import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from rtron.errors import InputError, suggestion
from rtron.sources.bounded_file import read_bounded
from rtron.vocabulary import Evidence, Ignore

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CONFIG_NAME = "rtron.toml"
MAX_BYTES = 2**20
_KEYS = ("rule", "topic", "reason")


def read_config(path: Path, rules: Collection[str]) -> tuple[Ignore, ...]:
    """Return what a file ignores; raise InputError where it is wrong. `rules` are those known."""
    try:
        text = read_bounded(path, MAX_BYTES).decode("utf-8")
        document = tomllib.loads(text)
    except UnicodeDecodeError:
        raise InputError("not UTF-8 text", path=str(path)) from None
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"not TOML: {error}", path=str(path)) from None
    lines = _entry_lines(text)
    return tuple(_ignores(document, Evidence(file=str(path)), rules, lines))


def config_json_schema(rules: Collection[str]) -> dict[str, Any]:
    """Return the JSON Schema of `rtron.toml`, for editors."""
    text = {"type": "string", "pattern": r"\S"}
    entry = {
        "type": "object",
        "description": "A finding that the report does not show again.",
        "properties": {
            "rule": {"enum": list(rules), "description": "The rule of the finding."},
            "topic": text
            | {"description": "The topic, service or node; * stands for anything.", "default": "*"},
            "reason": text | {"description": "Why it is no problem here."},
        },
        "required": ["rule", "reason"],
        "additionalProperties": False,
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": CONFIG_NAME,
        "type": "object",
        "properties": {"ignore": {"type": "array", "items": entry}},
        "additionalProperties": False,
    }


def _entry_lines(text: str) -> list[int]:
    """Return the lines of the `[[ignore]]` heads, from 1."""
    stripped = (line.replace(" ", "") for line in text.splitlines())
    return [number for number, line in enumerate(stripped, 1) if line.startswith("[[ignore]]")]


def _ignores(
    document: Mapping[str, Any], file: Evidence, rules: Collection[str], lines: list[int]
) -> Iterator[Ignore]:
    for name in document:
        if name != "ignore":
            raise InputError(
                f"unknown table {name[:80]!r}", path=file.file, help="write [[ignore]]"
            )
    entries = document.get("ignore", [])
    if not isinstance(entries, list):
        raise InputError("`ignore` is no list of tables", path=file.file, help="write [[ignore]]")
    for number, entry in enumerate(entries):
        line = lines[number] if len(lines) == len(entries) else 0
        yield _ignore(entry, Evidence(file=file.file, line=line), rules)


def _ignore(entry: object, place: Evidence, rules: Collection[str]) -> Ignore:
    if not isinstance(entry, dict):
        raise _error("an entry of `ignore` is no table", place, "write [[ignore]]")
    for key, value in entry.items():
        if key not in _KEYS:
            raise _error(f"unknown key {key[:80]!r}", place, suggestion(key, _KEYS))
        if not isinstance(value, str) or not value.strip():
            raise _error(f"`{key}` is no text", place, f'write {key} = "…"')
    for key in ("rule", "reason"):
        if key not in entry:
            raise _error(f"`{key}` is missing", place, f'add {key} = "…"')
    if entry["rule"] not in rules:
        raise _error(
            f"unknown rule {entry['rule'][:80]!r}", place, suggestion(entry["rule"], rules)
        )
    return Ignore(
        rule=entry["rule"],
        topic=entry.get("topic", "*"),
        reason=entry["reason"].strip(),
        place=place,
    )


def _error(message: str, place: Evidence, help: str) -> InputError:
    return InputError(message, path=place.file, line=place.line, help=help)
