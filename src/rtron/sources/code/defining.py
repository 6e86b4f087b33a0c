"""Which source of a package defines a class's methods or a function, told without parsing it."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_found
from rtron.sources.workspace.package_contents import Target, TargetKind

MAX_BYTES = 4 * 2**20
MAX_KEPT = 64 * 2**20

_METHOD = re.compile(rb"\b(\w+)(?:<[^<>;(){}]{0,200}>)?::~?(?:\w+)\s*\(")
_FUNCTION = re.compile(rb"^(?:[A-Za-z_][\w:<>,&* ]{0,200}[\s&*])?(\w+)\s*\(", re.MULTILINE)


@dataclass(eq=False, slots=True)
class Texts:
    """Reads sources; each is read once, as long as all that is kept is not too much."""

    _kept: dict[Path, bytes] = field(default_factory=dict)
    _size: int = 0

    def naming(self, sources: Iterable[Path], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""
        plain = word.encode("utf-8", "surrogateescape")
        letters = re.escape(plain)
        wanted = re.compile(rb"%b(?<=\b%b)\b" % (letters, letters))  # letters first: found faster
        texts = ((path, self._text(path)) for path in sources)
        return tuple(path for path, text in texts if plain in text and wanted.search(text))

    def _text(self, path: Path) -> bytes:
        known = self._kept.get(path)
        if known is None:
            known = _text(path)
            if self._size + len(known) <= MAX_KEPT:
                self._kept[path] = known
                self._size += len(known)
        return known


def defining(targets: Iterable[Target]) -> Mapping[str, tuple[Path, ...]]:
    """Return the sources of libraries that may define a class or function, by its plain name."""
    libraries = (target for target in targets if target.kind is TargetKind.LIBRARY)
    found: dict[str, list[Path]] = defaultdict(list)
    for path in dict.fromkeys(path for target in libraries for path in target.sources):
        for word in _words(path):
            found[word].append(path)
    return {word: tuple(paths) for word, paths in found.items()}


def _words(path: Path) -> set[str]:
    text = _text(path)
    return {word.decode() for form in (_METHOD, _FUNCTION) for word in form.findall(text)}


def _text(path: Path) -> bytes:
    try:
        return read_found(path, MAX_BYTES)
    except InputError:
        return b""
