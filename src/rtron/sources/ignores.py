"""What people do not want to be told again: `rtron.toml`, comments, and an earlier report.

`rtron.toml` has the findings that a project ignores, each with the reason:

    [[ignore]]
    rule = "several_publishers"
    topic = "/cmd_vel"            # optional, a pattern as the shell's; without it all topics
    reason = "a switch on the joystick parts the two"

A comment ignores a finding in the line of its evidence, or in the line before:

    pub = rospy.Publisher('/cmd_vel', Twist)  # rtron: ignore[several_publishers] a test rig
"""

import json
import re
import sys
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from rtron.errors import InputError, suggestion
from rtron.sources.bounded_file import read_bounded, read_regular_file
from rtron.vocabulary import RISKS_SCHEMA, Baseline, Evidence, Ignore

_MAX_SOURCE_BYTES = 2**22
_COMMENT = re.compile(r"rtron:\s{0,4}ignore\[(\w{1,40})\]\s{0,4}([^\n]{0,200})")
_CLOSINGS = ("-->", "*/")
_MAX_REPORT_BYTES = 2**26
_HELP = "write one with `rtron scan … --format json -o FILE`"


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


def read_baseline(path: Path) -> Baseline:
    """Return what an earlier scan has found; raise InputError if the file is no such report."""
    try:
        document = json.loads(read_bounded(path, _MAX_REPORT_BYTES))
    except (ValueError, RecursionError) as error:
        raise InputError(f"not JSON: {error}", path=str(path), help=_HELP) from None
    if not isinstance(document, dict) or document.get("schema") != RISKS_SCHEMA:
        raise InputError(f"no report of a scan ({RISKS_SCHEMA})", path=str(path), help=_HELP)
    try:
        findings = [*document["findings"], *(each["finding"] for each in document["ignored"])]
        return Baseline(
            {_text(each, "fingerprint"): _text(each, "id") for each in findings},
            frozenset(_text(each, "id") for each in document["risks"]),
        )
    except (KeyError, TypeError):
        raise InputError("a finding is incomplete", path=str(path), help=_HELP) from None


def _text(entry: Mapping[str, Any], key: str) -> str:
    text = entry[key]
    if not isinstance(text, str):
        raise TypeError
    return text


def comment_ignores(evidence: Iterable[Evidence], root: Path) -> Iterator[Ignore]:
    """Yield the comments beside what was read in files below `root`; a file that is gone has none.

    A comment without a reason ignores nothing.
    """
    lines: dict[str, set[int]] = defaultdict(set)
    for each in evidence:
        lines[each.file].update((each.line - 1, each.line))
    for name, numbers in lines.items():
        path = root / name
        if path.is_relative_to(root) and ".." not in path.parts:
            yield from _in_file(path, name, numbers)


def _in_file(path: Path, name: str, numbers: set[int]) -> Iterator[Ignore]:
    try:
        text = read_regular_file(path, _MAX_SOURCE_BYTES).decode("utf-8", "replace")
    except InputError:
        return
    for number, line in enumerate(text.split("\n"), 1):
        match = _COMMENT.search(line) if number in numbers else None
        reason = _reason(match[2]) if match else ""
        if match and reason:
            place = Evidence(file=name, line=number)
            yield Ignore(rule=match[1], reason=reason, place=place, is_comment=True)


def _reason(text: str) -> str:
    for end in _CLOSINGS:
        text = text.partition(end)[0]
    return text.strip()
