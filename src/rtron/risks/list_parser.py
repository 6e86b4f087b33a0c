"""A YAML file of lists, read and checked: every fault names the file and the nearest word."""

from collections.abc import Collection, Iterator, Mapping
from enum import Enum
from pathlib import Path
from typing import Any

import yaml

from rtron.errors import InputError, suggestion
from rtron.risks.topic_table import TopicTableEntry
from rtron.vocabulary import Domain, Sharing, StreamKind

ListFileContent = Mapping[str, tuple[Any, ...]]

MAX_BYTES = 2**20
WORD_LISTS = (
    "event_msg_type",
    "event_topic_name",
    "action_msg_type",
    "action_topic_name",
    "action_answer",
    "recog_topic_name",
    "image_type",
    "preprocessed_type",
    "max_vel_name",
    "max_vel_type",
    "ignored_topics",
    "ignored_types",
    "ignored_packages",
)
TABLES: Mapping[str, tuple[str, type[Enum]]] = {
    "domains": ("domain", Domain),
    "sharing": ("sharing", Sharing),
    "kinds": ("kind", StreamKind),
}


def read_text(path: Path) -> str:
    """Return a file's text; raise InputError if it cannot be read or is too large."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(path)) from None
    except UnicodeDecodeError:
        raise InputError("not UTF-8 text", path=str(path)) from None
    if len(data) > MAX_BYTES:
        raise InputError(f"larger than {MAX_BYTES} bytes", path=str(path))
    return text


def parse_lists(text: str, path: str) -> ListFileContent:
    """Return the lists and tables in a YAML text; raise InputError where one is wrong."""
    return dict(_checked(_parsed(text, path), path))


def _parsed(text: str, path: str) -> Mapping[Any, Any]:
    try:
        document = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 0
        raise InputError(f"not YAML: {error.problem}", path=path, line=line) from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError(f"not YAML: {error}", path=path) from None
    if not isinstance(document, dict):
        raise InputError("holds no lists", path=path, help=f"lists are {', '.join(WORD_LISTS)}")
    return document


def _checked(document: Mapping[Any, Any], path: str) -> Iterator[tuple[str, tuple[Any, ...]]]:
    for name, value in document.items():
        if name in TABLES:
            yield name, tuple(_entry(entry, name, path) for entry in _list(value, name, path))
        elif name in WORD_LISTS:
            yield name, _words(value, name, path)
        else:
            raise _unknown("list", name, (*WORD_LISTS, *TABLES), path)


def _entry(entry: object, table: str, path: str) -> TopicTableEntry:
    key, words = TABLES[table]
    if not isinstance(entry, dict) or key not in entry:
        raise InputError(
            f"an entry of {table} needs `{key}:` with `types:` or `topics:`", path=path
        )
    for name in entry:
        if name not in {key, "types", "topics"}:
            raise _unknown(f"key in {table}", name, (key, "types", "topics"), path)
    known = [str(word.value) for word in words]
    if entry[key] not in known:
        raise _unknown(key, entry[key], known, path)
    types = _words(entry.get("types", []), f"types of {entry[key]}", path)
    topics = _words(entry.get("topics", []), f"topics of {entry[key]}", path)
    if not types and not topics:
        raise InputError(f"an entry of {table} has neither types nor topics", path=path)
    return TopicTableEntry(category=entry[key], types=types, topics=topics)


def _words(value: object, name: str, path: str) -> tuple[str, ...]:
    words = _list(value, name, path)
    for word in words:
        if not isinstance(word, str) or not word:
            raise InputError(f"{name} holds {word!r:.40}, which is no text", path=path)
    return tuple(words)


def _list(value: object, name: str, path: str) -> list[Any]:
    if not isinstance(value, list):
        raise InputError(f"{name} is no list", path=path, help=f"write `{name}: [first, second]`")
    return value


def _unknown(what: str, word: object, known: Collection[str], path: str) -> InputError:
    text = str(word)[:80]
    return InputError(f"unknown {what} {text!r}", path=path, help=suggestion(text, known))
