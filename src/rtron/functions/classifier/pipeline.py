"""From a repository's text to its functions (paper A.2): the name, then manifests, then README."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.functions.classifier.package_stack import functional, stack_scores, union
from rtron.functions.classifier.result import Classification, DecidedBy, Evidence, Piece
from rtron.functions.classifier.scores import Scores, scores
from rtron.functions.text.descriptions import description_tokens
from rtron.functions.text.names import name_tokens
from rtron.functions.text.prose import readme_tokens

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rtron.functions.repository import Package, Repository
    from rtron.vocabulary import FunctionType

_LATER_SENTENCE = 0.6
_README_START = 3
_README_LATER = 0.15
_MARGIN = 0.3
_SURE = 4.3


def classify(repository: Repository) -> Classification:
    """Return a repository's functions; the first piece that decides ends the search for the first.

    A name that tells weakly is believed if the manifests do not outweigh it. A repository of
    several packages has those functions too that its packages have.
    """
    packages = {package.name: package_scores(package) for package in repository.packages}
    weighed, leading, told_by = Scores(), None, DecidedBy.NONE
    for piece, more in _pieces(repository, packages):
        weighed += more()
        leader = _decided(weighed)
        if leader is not leading:
            leading, told_by = leader, DecidedBy(piece)
        if leader and (piece is not Piece.NAME or weighed.weights[leader] >= _SURE):
            functions = union(leader, weighed, functional(packages))
            return _classified(repository, functions, told_by, weighed, packages)
    return _classified(repository, (), DecidedBy.NONE, weighed, packages)


def classify_name(package_name: str, description: str = "") -> tuple[FunctionType, ...]:
    """Return what a package's name and description tell, the strongest first; none if nothing."""
    name = _name(package_name)
    return name.ranked() or (name + _description(description)).ranked()


def package_scores(package: Package) -> Scores:
    """Return what a package's own name and description tell."""
    return _name(package.name, package.name) + _description(package.description, package.name)


def _pieces(
    repository: Repository, packages: Mapping[str, Scores]
) -> Iterator[tuple[Piece, Callable[[], Scores]]]:
    yield Piece.NAME, lambda: _name(repository.name)
    yield Piece.MANIFEST, lambda: _manifests(repository, packages)
    yield Piece.README, lambda: _readme(repository.readme)


def _name(name: str, package: str = "") -> Scores:
    return scores([(name_tokens(name), 1.0)], Piece.NAME, package)


def _description(description: str, package: str = "") -> Scores:
    parts = enumerate(description_tokens(description))
    texts = ((tokens, _LATER_SENTENCE if at else 1.0) for at, tokens in parts)
    return scores(texts, Piece.MANIFEST, package)


def _manifests(repository: Repository, packages: Mapping[str, Scores]) -> Scores:
    own = [p for p in repository.packages if p.name == repository.name]
    told = Scores()
    for package in own:
        told += _description(package.description, package.name)
    others = {name: found for name, found in packages.items() if name != repository.name}
    return told + stack_scores(functional(others).values())


def _readme(readme: str) -> Scores:
    parts = enumerate(readme_tokens(readme))
    texts = ((tokens, 1.0 if at < _README_START else _README_LATER) for at, tokens in parts)
    return scores(texts, Piece.README)


def _decided(weighed: Scores) -> FunctionType | None:
    ranked = weighed.ranked()
    if not ranked:
        return None
    second = max((w for type, w in weighed.weights.items() if type is not ranked[0]), default=0.0)
    return ranked[0] if weighed.weights[ranked[0]] - second >= _MARGIN else None


def _classified(
    repository: Repository,
    functions: tuple[FunctionType, ...],
    decided_by: DecidedBy,
    weighed: Scores,
    packages: Mapping[str, Scores],
) -> Classification:
    return Classification(
        repo=repository.name,
        functions=functions,
        primary=functions[0] if functions else None,
        decided_by=decided_by,
        evidence=tuple(_evidence(functions, weighed, packages)),
        packages={name: found.ranked() for name, found in packages.items()},
    )


def _evidence(
    functions: tuple[FunctionType, ...], weighed: Scores, packages: Mapping[str, Scores]
) -> Iterator[Evidence]:
    """Yield what tells the functions, of a repository that has none whatever speaks of any.

    Packages are asked for the functions that nothing else tells.
    """
    yield from (each for each in weighed.evidence if each.type in functions or not functions)
    told = {each.type for each in weighed.evidence}
    for found in packages.values():
        missing = (each for each in found.evidence if each.type not in told)
        yield from (each for each in missing if each.type in functions)
