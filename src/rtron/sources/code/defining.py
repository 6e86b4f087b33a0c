"""Which source of a package defines a class's methods or a function, told without parsing it."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded import read_bounded
from rtron.sources.workspace.package import Target, TargetKind

MAX_BYTES = 4 * 2**20

_METHOD = re.compile(rb"\b(\w+)(?:<[^<>;(){}]{0,200}>)?::~?(?:\w+)\s*\(")
_FUNCTION = re.compile(rb"^(?:[A-Za-z_][\w:<>,&* ]{0,200}[\s&*])?(\w+)\s*\(", re.MULTILINE)


def defining(targets: Iterable[Target]) -> Mapping[str, tuple[Path, ...]]:
    """Return the sources of libraries that may define a class or function, by its plain name."""
    libraries = (target for target in targets if target.kind is TargetKind.LIBRARY)
    found: dict[str, list[Path]] = defaultdict(list)
    for path in dict.fromkeys(path for target in libraries for path in target.sources):
        for word in _words(path):
            found[word].append(path)
    return {word: tuple(paths) for word, paths in found.items()}


def naming(sources: Iterable[Path], word: str) -> tuple[Path, ...]:
    """Return those of some sources whose text has a word."""
    wanted = re.compile(rb"\b%b\b" % re.escape(word.encode("utf-8", "surrogateescape")))
    return tuple(path for path in sources if wanted.search(_text(path)))


def _words(path: Path) -> set[str]:
    text = _text(path)
    return {word.decode() for form in (_METHOD, _FUNCTION) for word in form.findall(text)}


def _text(path: Path) -> bytes:
    try:
        return read_bounded(path, MAX_BYTES)
    except InputError:
        return b""
