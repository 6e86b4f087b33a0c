"""Repositories labelled by hand with their functions, and classifications beside them.

`python -m evaluation.common.function_labels LABELS CLASSES` scores what `rtron classify` wrote.
"""

import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from evaluation.common.reliability import Reliability, reliability, reliability_lines
from rtron.functions.classifier.result import Classification, DecisionSource
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.vocabulary import Domain, FunctionType

HALVES = ("develop", "check")
"""What the labels of each half are for: to write rules with, and to check them."""
CHECK = HALVES.index("check")


@dataclass(frozen=True, slots=True, kw_only=True)
class Label:
    """What readers say a repository is: any one of `primary` is right as its first function.

    `accepted` functions count neither as wrong nor as missed.
    """

    repo: str
    primary: frozenset[FunctionType]
    functions: frozenset[FunctionType]
    accepted: frozenset[FunctionType]

    @property
    def is_node(self) -> bool:
        """Tell whether its first function is a node of the interaction graph."""
        return all(DOMAIN_BY_TYPE[type] is not Domain.OTHERS for type in self.primary)

    def share_as_first(self, function: FunctionType | None) -> float:
        """Return the share of the readings that give a function as the first, 0 to 1."""
        return (function in self.primary) / len(self.primary)

    @property
    def half(self) -> int:
        """Return 0 for the half that the rules were made with, 1 for the one that checks them."""
        return half_of(self.repo)


def half_of(repo: str) -> int:
    """Return the half of the labels that a repository is in, by its name."""
    return sha256(repo.encode()).digest()[0] % 2


@dataclass(frozen=True, slots=True)
class FunctionScore:
    """Classifications beside their labels."""

    pairs: tuple[tuple[Label, Classification], ...]

    @property
    def automation(self) -> float:
        """Return the share of the repositories of function nodes that a rule decides."""
        nodes = [found for label, found in self.pairs if label.is_node]
        return _share(sum(map(_is_decided, nodes)), len(nodes))

    @property
    def precision(self) -> float:
        """Return the share of the decided repositories whose first function is right."""
        decided = [pair for pair in self.pairs if _is_decided(pair[1])]
        return _share(sum(found.primary in label.primary for label, found in decided), len(decided))

    @property
    def accuracy(self) -> float:
        """Return the share of all repositories whose first function is right, decided or not."""
        right = sum(found.primary in label.primary for label, found in self.pairs)
        return _share(right, len(self.pairs))

    @property
    def decided(self) -> float:
        """Return the share of all repositories that a rule decides."""
        return _share(sum(_is_decided(found) for _, found in self.pairs), len(self.pairs))

    @property
    def agreement(self) -> float:
        """Return the share of all readings that give a repository the same first function."""
        shares = sum(label.share_as_first(found.primary) for label, found in self.pairs)
        return shares / len(self.pairs) if self.pairs else 0.0

    @property
    def f1(self) -> float:
        """Return the harmonic mean of precision and recall over all functions together."""
        hits = sum(len(label.functions & set(found.functions)) for label, found in self.pairs)
        wrong = sum(
            len(_extra(label, found)) + len(_missed(label, found)) for label, found in self.pairs
        )
        return _share(2 * hits, 2 * hits + wrong)

    @property
    def reliability(self) -> Reliability:
        """Return how well the probabilities of the first functions fit what the readers say."""
        probabilities = np.array([found.confidence or 0.0 for _, found in self.pairs])
        right = np.array([label.share_as_first(found.primary) for label, found in self.pairs])
        return reliability(probabilities, right)

    def differences(self) -> Iterator[str]:
        """Yield a line for each repository with a function that is wrong or missed."""
        for label, found in self.pairs:
            extra, missed = _extra(label, found), _missed(label, found)
            if extra or missed or found.primary not in label.primary:
                right = "WRONG" if found.primary not in label.primary else "PART"
                yield (
                    f"{right:5} {label.repo}: {found.primary}"
                    f" ({'/'.join(sorted(label.primary))}), extra {_names(extra)},"
                    f" missed {_names(missed)}"
                )


def read_labels(path: Path) -> tuple[Label, ...]:
    """Return the labels in a file of JSON lines."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return tuple(_label(json.loads(line)) for line in lines)


def read_classifications(path: Path) -> Mapping[str, Classification]:
    """Return the classifications that `rtron classify` wrote to a file, by their repositories."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return {found.repo: found for found in map(_classification, map(json.loads, lines))}


def score(labels: Iterable[Label], found: Mapping[str, Classification]) -> FunctionScore:
    """Return labels beside what was found; a label whose repository is absent is left out."""
    return FunctionScore(tuple((each, found[each.repo]) for each in labels if each.repo in found))


def _label(document: Mapping[str, list[str]]) -> Label:
    return Label(
        repo=str(document["repo"]),
        primary=_types(document["primary"]),
        functions=_types(document["functions"]),
        accepted=_types(document["also_accepted"]),
    )


def _classification(document: Mapping[str, Any]) -> Classification:
    functions = tuple(map(FunctionType, document["functions"]))
    return Classification(
        repo=document["repo"],
        functions=functions,
        primary=functions[0],
        probabilities={
            FunctionType(name): share for name, share in document["probabilities"].items()
        },
        decided_by=DecisionSource(document["decided_by"]),
    )


def _is_decided(found: Classification) -> bool:
    return found.decided_by is not DecisionSource.NONE


def _types(names: Iterable[str]) -> frozenset[FunctionType]:
    return frozenset(map(FunctionType, names))


def _extra(label: Label, found: Classification) -> frozenset[FunctionType]:
    return frozenset(found.functions) - label.functions - label.accepted


def _missed(label: Label, found: Classification) -> frozenset[FunctionType]:
    return label.functions - set(found.functions)


def _names(types: Iterable[FunctionType]) -> str:
    return ", ".join(sorted(types)) or "none"


def _share(part: int, total: int) -> float:
    return part / total if total else 0.0


def main(files: Sequence[str]) -> None:
    """Print the scores of both halves and of all labels whose repositories are classified.

    Then print how well the first functions' probabilities fit.
    """
    labels, found = read_labels(Path(files[0])), read_classifications(Path(files[1]))
    halves = {name: [each for each in labels if each.half == at] for at, name in enumerate(HALVES)}
    for name, chosen in {**halves, "all": labels}.items():
        scored = score(chosen, found)
        print(  # noqa: T201 - what it is for
            f"{name:8}{len(scored.pairs):4} repositories, decided {scored.decided:.3f}, correct of "
            f"these {scored.precision:.3f}, of all {scored.accuracy:.3f}, "
            f"agreement {scored.agreement:.3f}, F1 {scored.f1:.3f}"
        )
    fit = score(labels, found).reliability
    print("\n".join(reliability_lines("first functions", fit)))  # noqa: T201 - nor is this


if __name__ == "__main__":
    main(sys.argv[1:])
