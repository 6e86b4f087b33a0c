"""The paper's two tables, counted anew: repositories by type, and what decided each.

As in the paper a repository counts once for each of its functions. One that nothing decides has
none; it is counted as an Extension that a person has to look at, as half of those are in the paper
(106 of 206).
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rtron.functions.classifier.result import Classification, DecidedBy, Evidence, Piece
from rtron.functions.classifier.tally import Tally
from rtron.functions.domains import DOMAIN_OF
from rtron.vocabulary import Domain, FunctionType


@dataclass(frozen=True, slots=True, kw_only=True)
class Tables:
    """How many repositories there are, how many are decided, and the tally of every type."""

    repositories: int
    decided: int
    types: Mapping[FunctionType, Tally]


def count(classifications: Iterable[Classification]) -> Tables:
    """Return the tables of some classifications."""
    found = list(classifications)
    counts = Counter(pair for each in found for pair in _counted(each))
    types = {
        type: Tally(**{str(by): counts[type, by] for by in DecidedBy}) for type in FunctionType
    }
    decided = sum(each.decided_by is not DecidedBy.NONE for each in found)
    return Tables(repositories=len(found), decided=decided, types=types)


def sum_of(types: Mapping[FunctionType, Tally], domains: Iterable[Domain]) -> Tally:
    """Return the tallies of some domains' types together."""
    wanted = set(domains)
    return sum((types[type] for type in types if DOMAIN_OF[type] in wanted), Tally())


def function_nodes(types: Mapping[FunctionType, Tally]) -> Tally:
    """Return the tally of the types that are nodes of an interaction graph: all but Others."""
    return sum_of(types, set(Domain) - {Domain.OTHERS})


def _counted(classification: Classification) -> Iterator[tuple[FunctionType, DecidedBy]]:
    if not classification.functions:
        yield FunctionType.EXTENSION, DecidedBy.NONE
    for type in classification.functions:
        yield type, _decided(classification, type)


def _decided(classification: Classification, type: FunctionType) -> DecidedBy:
    """Return what decided a repository's type: of one that is not the primary, what told it first.

    A package's name stands in its manifest: only that of the repository counts as a name.
    """
    if type is classification.primary:
        return classification.decided_by
    pieces = {_piece(each) for each in classification.evidence if each.type is type}
    return next((by for by in DecidedBy if str(by) in pieces), classification.decided_by)


def _piece(evidence: Evidence) -> Piece:
    named = evidence.piece is Piece.NAME and evidence.package
    return Piece.MANIFEST if named else evidence.piece
