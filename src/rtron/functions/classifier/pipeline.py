"""From a repository to its functions (paper A.2): its name, manifests, code, then README."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.classifier.package_stack import (
    functional_packages,
    repository_functions,
    score_packages,
    score_repository_code,
)
from rtron.functions.classifier.result import (
    Classification,
    DecisionSource,
    InformationSource,
    RuleEvidence,
)
from rtron.functions.classifier.scores import (
    FunctionScores,
    function_probabilities,
    score_package_code,
    score_texts,
)
from rtron.functions.text import description_tokens, name_tokens, readme_tokens
from rtron.vocabulary import FunctionType

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rtron.functions.repository import SourcePackage, SourceRepository

_LATER_SENTENCE_WEIGHT = 0.6
_README_LEADING_SENTENCES = 3
_README_LATER_WEIGHT = 0.15
_PACKAGE_CODE_WEIGHT = 0.5
_MIN_PROBABILITY = 0.5
_LEAD_MARGIN = 0.3
_CERTAIN_NAME_WEIGHT = 4.3
_SPECIFIC_WEIGHT = 4.0
_NEAR_SHARE = 0.8
_UNDECIDED = FunctionType.EXTENSION
"""What a repository most likely is if no rule tells enough: libraries and tools name no robot."""


def classify(repository: SourceRepository) -> Classification:
    """Return a repository's functions; the first piece that decides ends the search for the first.

    A name that tells weakly is believed if the manifests do not outweigh it. A repository of
    several packages has those functions too that its packages have. How sure each function is
    depends on all pieces. One that nothing decides most likely is an Extension, and this unsure.
    """
    words = package_words(repository)
    by_source = source_scores(repository, words)
    packages = {p.name: words[p.name] + _code_hints(p) for p in repository.packages}
    decision = _decide(by_source)
    candidates: tuple[FunctionType, ...] = (decision.function,)
    if decision.source is not DecisionSource.NONE:
        functional = functional_packages(packages)
        candidates = repository_functions(decision.function, decision.scores, functional)
    probabilities = function_probabilities(candidates, by_source)
    return _classification(repository, probabilities, decision, packages)


def classify_name(package_name: str, description: str = "") -> tuple[FunctionType, ...]:
    """Return what a package's name and description tell, the strongest first; none if nothing."""
    name = _name_scores(package_name)
    return name.ranked() or (name + _description_scores(description)).ranked()


def package_words(repository: SourceRepository) -> Mapping[str, FunctionScores]:
    """Return what the name and the description of each package tell, by its name."""
    return {
        package.name: _name_scores(package.name, package.name)
        + _description_scores(package.description, package.name)
        for package in repository.packages
    }


def _code_hints(package: SourcePackage) -> FunctionScores:
    return score_package_code(package).scaled(_PACKAGE_CODE_WEIGHT)


def source_scores(
    repository: SourceRepository, words: Mapping[str, FunctionScores]
) -> Mapping[InformationSource, FunctionScores]:
    """Return what each piece of a repository tells, in the order in which they are asked.

    `words` are what its packages' names and descriptions tell.
    """
    return {
        InformationSource.NAME: _name_scores(repository.name),
        InformationSource.MANIFEST: _manifest_scores(repository, words),
        InformationSource.CODE: score_repository_code(repository.packages),
        InformationSource.README: _readme_scores(repository.readme),
    }


def _name_scores(name: str, package: str = "") -> FunctionScores:
    return score_texts([(name_tokens(name), 1.0)], InformationSource.NAME, package)


def _description_scores(description: str, package: str = "") -> FunctionScores:
    parts = enumerate(description_tokens(description))
    texts = ((tokens, _LATER_SENTENCE_WEIGHT if at else 1.0) for at, tokens in parts)
    return score_texts(texts, InformationSource.MANIFEST, package)


def _manifest_scores(
    repository: SourceRepository, words: Mapping[str, FunctionScores]
) -> FunctionScores:
    root_packages = [p for p in repository.packages if p.name == repository.name]
    scores = FunctionScores()
    for package in root_packages:
        scores += _description_scores(package.description, package.name)
    others = {name: found for name, found in words.items() if name != repository.name}
    return scores + score_packages(functional_packages(others).values())


def _readme_scores(readme: str) -> FunctionScores:
    parts = enumerate(readme_tokens(readme))
    texts = (
        (tokens, 1.0 if at < _README_LEADING_SENTENCES else _README_LATER_WEIGHT)
        for at, tokens in parts
    )
    return score_texts(texts, InformationSource.README)


def _leading_type(scores: FunctionScores) -> FunctionType | None:
    ranked = scores.ranked()
    if not ranked:
        return None
    second = max((w for type, w in scores.weights.items() if type is not ranked[0]), default=0.0)
    return ranked[0] if scores.weights[ranked[0]] - second >= _LEAD_MARGIN else None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Decision:
    """The first function, the piece that decided, and what the pieces asked tell together."""

    function: FunctionType
    source: DecisionSource
    scores: FunctionScores


def _decide(by_source: Mapping[InformationSource, FunctionScores]) -> _Decision:
    total, previous_leader, decided_by = FunctionScores(), None, DecisionSource.NONE
    for source, scores in by_source.items():
        total += scores
        leader = _leading_type(total)
        if leader is not previous_leader:
            previous_leader, decided_by = leader, DecisionSource(source)
        is_name = source is InformationSource.NAME
        if leader and not (is_name and total.weights[leader] < _CERTAIN_NAME_WEIGHT):
            decision = _Decision(function=leader, source=decided_by, scores=total)
            return _specific(decision, by_source) or decision
    return _Decision(function=_UNDECIDED, source=DecisionSource.NONE, scores=total)


def _specific(
    decision: _Decision, by_source: Mapping[InformationSource, FunctionScores]
) -> _Decision | None:
    """Return what else all pieces tell about as strongly of an Extension, None if nothing.

    Libraries, messages and tools are of something: only a name that says so clearly outweighs it.
    """
    name = by_source[InformationSource.NAME].weights.get(FunctionType.EXTENSION, 0.0)
    if decision.function is not FunctionType.EXTENSION or name >= _CERTAIN_NAME_WEIGHT:
        return None
    total = sum(by_source.values(), FunctionScores())
    others = dict(total.weights)
    enough = max(_SPECIFIC_WEIGHT, _NEAR_SHARE * others.pop(FunctionType.EXTENSION))
    function = _leading_type(FunctionScores(others))
    if function is None or others[function] < enough:
        return None
    source = max(by_source, key=lambda each: by_source[each].weights.get(function, 0.0))
    return _Decision(function=function, source=DecisionSource(source), scores=total)


def _classification(
    repository: SourceRepository,
    probabilities: Mapping[FunctionType, float],
    decision: _Decision,
    packages: Mapping[str, FunctionScores],
) -> Classification:
    functions = tuple(_likely_functions(probabilities))
    is_decided = decision.source is not DecisionSource.NONE
    scores = decision.scores
    evidence = _evidence(functions, scores, packages) if is_decided else scores.evidence
    return Classification(
        repo=repository.name,
        functions=functions,
        primary=functions[0],
        probabilities=probabilities,
        decided_by=decision.source,
        evidence=tuple(dict.fromkeys(evidence)),
        packages={name: package_score.ranked() for name, package_score in packages.items()},
    )


def _likely_functions(probabilities: Mapping[FunctionType, float]) -> Iterator[FunctionType]:
    """Yield the first candidate, and those others that are more likely than not."""
    for at, (function, probability) in enumerate(probabilities.items()):
        if at == 0 or probability >= _MIN_PROBABILITY:
            yield function


def _evidence(
    functions: tuple[FunctionType, ...],
    scores: FunctionScores,
    packages: Mapping[str, FunctionScores],
) -> Iterator[RuleEvidence]:
    """Yield what tells the functions; packages are asked for those that nothing else tells."""
    yield from (each for each in scores.evidence if each.type in functions)
    known_types = {each.type for each in scores.evidence}
    for package_score in packages.values():
        missing = (each for each in package_score.evidence if each.type not in known_types)
        yield from (each for each in missing if each.type in functions)
