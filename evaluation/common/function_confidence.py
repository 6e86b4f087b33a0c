"""How sure the classifier is beside how often it is right: learned and measured on labels by hand.

`python -m evaluation.common.function_confidence [--write]` prints the reliability table, and with
`--write` learns the weights of `confidence.yaml`, from the labels that check the rules: those that
the rules were written with would teach too much trust. What it measures, it measures by
cross-validation: each repository with weights that were learned from others.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from importlib.resources import files
from pathlib import Path

import numpy as np
import numpy.typing as npt
import yaml

from evaluation.common.datasets import Datasets, Reporter, datasets_from_environ
from evaluation.common.function_corpora import HELD_OUT, read_repositories
from evaluation.common.function_labels import CHECK, Label, half_of, read_labels
from evaluation.common.reliability import Array, Reliability, reliability, reliability_lines
from figures.figure import Figure
from rtron.functions.classifier.pipeline import classify, package_words, source_scores
from rtron.functions.classifier.scores import FEATURES, features
from rtron.functions.repository import SourceRepository
from rtron.vocabulary import FunctionType

POSITIONS = ("first", "others")
_FOLDS = 10
_RIDGE = 1.0
_STEPS = 30


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """A function that the classifier gives a repository: its features, and the readers' share.

    `view` is what of the repository was there to read.
    """

    repo: str
    view: str
    position: str
    features: tuple[float, ...]
    right: float

    @property
    def fold(self) -> int:
        """The part of the cross-validation that the repository is in, whatever was read of it."""
        return int.from_bytes(sha256(self.repo.encode()).digest()[1:3], "big") % _FOLDS


def cross_validated(answers: Sequence[Answer]) -> Array:
    """Return the probability of each answer, by weights learned from other repositories."""
    probabilities = np.zeros(len(answers))
    folds, positions = (
        np.array([each.fold for each in answers]),
        np.array([each.position for each in answers]),
    )
    for position in POSITIONS:
        for fold in range(_FOLDS):
            tested = (positions == position) & (folds == fold)
            weights = _fit(_chosen(answers, (positions == position) & (folds != fold)))
            probabilities[tested] = _predict(weights, _matrix(_chosen(answers, tested)))
    return probabilities


def learned_weights(answers: Sequence[Answer]) -> Mapping[str, Mapping[str, float]]:
    """Return the weights of the features that all answers teach, as `confidence.yaml` has them."""
    by_position = {p: [each for each in answers if each.position == p] for p in POSITIONS}
    return {
        position: dict(zip(FEATURES, np.round(_fit(of_position), 3).tolist(), strict=True))
        for position, of_position in by_position.items()
    }


def labelled_answers(
    labels: Iterable[Label], repositories: Mapping[str, SourceRepository]
) -> Iterator[Answer]:
    """Yield what the classifier says of labelled repositories, also of parts of their text."""
    for label in labels:
        for view, repository in _views(repositories[label.repo]):
            yield from _answers(label, view, repository)


def _views(repository: SourceRepository) -> Iterator[tuple[str, SourceRepository]]:
    """Yield a repository as it is, without its README, and its names alone."""
    yield "all", repository
    if repository.readme:
        yield "manifests", replace(repository, readme="")
    names = tuple(replace(p, description="", depends=()) for p in repository.packages)
    if names != repository.packages:
        yield "names", replace(repository, packages=names, readme="")


def _answers(label: Label, view: str, repository: SourceRepository) -> Iterator[Answer]:
    scores = source_scores(repository, package_words(repository))
    for at, function in enumerate(classify(repository).probabilities):
        yield Answer(
            repo=label.repo,
            view=view,
            position=POSITIONS[min(at, 1)],
            features=features(function, scores),
            right=_share_as_other(label, function) if at else label.share_as_first(function),
        )


def _share_as_other(label: Label, function: FunctionType) -> float:
    return 1.0 if function in label.functions else 0.5 * (function in label.accepted)


def _fit(answers: Sequence[Answer]) -> Array:
    """Return the weights of a logistic regression (ridge, Newton's method)."""
    matrix, right = _matrix(answers), _right(answers)
    ridge = _RIDGE * np.eye(len(FEATURES))
    ridge[0, 0] = 1e-6
    weights = np.zeros(len(FEATURES))
    for _ in range(_STEPS):
        predicted = _predict(weights, matrix)
        gradient = matrix.T @ (predicted - right) + ridge @ weights
        curvature = (matrix.T * (predicted * (1 - predicted))) @ matrix + ridge
        weights = weights - np.linalg.solve(curvature, gradient)
    return weights


def _predict(weights: Array, matrix: Array) -> Array:
    predicted: Array = 1 / (1 + np.exp(-(matrix @ weights)))
    return predicted


def _matrix(answers: Sequence[Answer]) -> Array:
    return np.array([each.features for each in answers]).reshape(len(answers), len(FEATURES))


def _right(answers: Sequence[Answer]) -> Array:
    return np.array([each.right for each in answers])


def _chosen(answers: Sequence[Answer], mask: npt.NDArray[np.bool_]) -> list[Answer]:
    return [each for each, is_chosen in zip(answers, mask, strict=True) if is_chosen]


def held_out_answers(datasets: Datasets) -> list[Answer]:
    """Return the answers for every repository with held-out labels."""
    return [
        answer
        for corpus in HELD_OUT
        for answer in labelled_answers(
            read_labels(corpus.labels), read_repositories(corpus, datasets)
        )
    ]


def confidence_figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Measure by cross-validation how well the classifier knows how sure it is."""
    reporter.progress("how sure the classifier is, cross-validated")
    answers = held_out_answers(datasets)
    for position, view, found in _reliabilities(answers):
        reporter.detail([*reliability_lines(f"{position} functions, {view}", found), ""])
        name = f"functions.confidence.{position}.{view}"
        yield Figure(f"{name}.brier", found.brier, found.base, "")
        yield Figure(f"{name}.calibration_error", found.calibration_error, None, "share")


def _reliabilities(answers: Sequence[Answer]) -> Iterator[tuple[str, str, Reliability]]:
    probabilities, right = cross_validated(answers), _right(answers)
    for position in POSITIONS:
        for view in dict.fromkeys(each.view for each in answers):
            chosen = np.array([(each.position, each.view) == (position, view) for each in answers])
            yield position, view, reliability(probabilities[chosen], right[chosen])


def main(arguments: Sequence[str]) -> None:
    """Print the reliability of every view; write the weights if asked to."""
    answers = held_out_answers(datasets_from_environ())
    for position, view, found in _reliabilities(answers):
        print("\n".join(reliability_lines(f"{position} functions, {view}", found)))  # noqa: T201 - what it is for
    if "--write" in arguments:
        path = Path(str(files("rtron.functions.classifier") / "confidence.yaml"))
        checking = [each for each in answers if half_of(each.repo) == CHECK]
        weights = yaml.safe_dump(learned_weights(checking), sort_keys=False)
        path.write_text(_HEADER + weights, encoding="utf-8")


_HEADER = """\
# How much each piece of key information counts for a function, and against it: the weights of a
# logistic regression, for the first function of a repository and for its others. Learned from the
# check halves of evaluation/data/function_labels.jsonl and function_labels_ros2.jsonl:
# python -m evaluation.common.function_confidence --write

"""

if __name__ == "__main__":
    main(sys.argv[1:])
