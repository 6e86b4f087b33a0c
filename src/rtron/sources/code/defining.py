"""Which source of a package defines a class's methods or a function, told without parsing it."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.workspace.package_contents import BuildTarget, TargetKind

MAX_BYTES = 4 * 2**20
MAX_CACHED = 64 * 2**20

_METHOD = re.compile(rb"\b(\w+)(?:<[^<>;(){}]{0,200}>)?::~?(?:\w+)\s*\(")
_FUNCTION = re.compile(rb"^(?:[A-Za-z_][\w:<>,&* ]{0,200}[\s&*])?(\w+)\s*\(", re.MULTILINE)


@dataclass(eq=False, slots=True)
class SourceTexts:
    """Reads sources; each is read once, as long as all that is kept is not too much."""

    _cache: dict[Path, bytes] = field(default_factory=dict)
    _size: int = 0

    def sources_containing(self, sources: Iterable[Path], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""
        plain = word.encode("utf-8", "surrogateescape")
        letters = re.escape(plain)
        word_pattern = re.compile(
            rb"%b(?<=\b%b)\b" % (letters, letters)
        )  # letters first: found faster
        texts = ((path, self._source_text(path)) for path in sources)
        return tuple(path for path, text in texts if plain in text and word_pattern.search(text))

    def _source_text(self, path: Path) -> bytes:
        known = self._cache.get(path)
        if known is None:
            known = _read_source(path)
            if self._size + len(known) <= MAX_CACHED:
                self._cache[path] = known
                self._size += len(known)
        return known


def sources_by_definition(targets: Iterable[BuildTarget]) -> Mapping[str, tuple[Path, ...]]:
    """Return the sources of libraries that may define a class or function, by its plain name."""
    libraries = (target for target in targets if target.kind is TargetKind.LIBRARY)
    found: dict[str, list[Path]] = defaultdict(list)
    for path in dict.fromkeys(path for target in libraries for path in target.sources):
        for word in _defined_names(path):
            found[word].append(path)
    return {word: tuple(paths) for word, paths in found.items()}


def _defined_names(path: Path) -> set[str]:
    text = _read_source(path)
    return {word.decode() for form in (_METHOD, _FUNCTION) for word in form.findall(text)}


def _read_source(path: Path) -> bytes:
    try:
        return read_regular_file(path, MAX_BYTES)
    except InputError:
        return b""
