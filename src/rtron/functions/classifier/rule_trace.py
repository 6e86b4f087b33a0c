"""Every rule that matches anywhere in a repository's text, asked or not: what explains a class."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.classifier.result import Piece
from rtron.functions.rules.loader import rule_index
from rtron.functions.text.descriptions import description_tokens
from rtron.functions.text.names import name_tokens
from rtron.functions.text.prose import readme_tokens

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.functions.repository import Package, Repository
    from rtron.functions.text.tokens import Tokens
    from rtron.vocabulary import FunctionType


@dataclass(frozen=True, slots=True, kw_only=True)
class Matched:
    """A rule that matches on some words of a piece; one that is vetoed does not count.

    `package` is the package whose name or description it is, "" where it is the repository's own.
    """

    package: str
    piece: Piece
    text: str
    rule: str
    type: FunctionType
    weight: float
    vetoed: bool


def trace(repository: Repository) -> tuple[Matched, ...]:
    """Return what matches in a repository: its name, its packages' texts, its README.

    A rule that matches a piece several times is listed once for each text that it matches on.
    """
    found = [*_in(name_tokens(repository.name), Piece.NAME)]
    for package in repository.packages:
        found += _in_package(package)
    for tokens in readme_tokens(repository.readme):
        found += _in(tokens, Piece.README)
    return tuple(dict.fromkeys(found))


def _in_package(package: Package) -> Iterator[Matched]:
    yield from _in(name_tokens(package.name), Piece.NAME, package.name)
    for tokens in description_tokens(package.description):
        yield from _in(tokens, Piece.MANIFEST, package.name)


def _in(tokens: Tokens, piece: Piece, package: str = "") -> Iterable[Matched]:
    return (
        Matched(
            package=package,
            piece=piece,
            text=" ".join(tokens.words[match.start : match.end]),
            rule=match.of.id,
            type=match.of.type,
            weight=match.of.weight,
            vetoed=match.of.vetoed(tokens),
        )
        for match in rule_index().find(tokens)
        if piece in match.of.pieces
    )
