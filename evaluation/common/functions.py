"""Corpora of repositories, classified: beside labels by hand, and beside the paper's figures."""

from collections.abc import Iterator, Mapping

from evaluation.common.datasets import Datasets, Reporter
from evaluation.common.function_confidence import confidence_figures
from evaluation.common.function_corpora import (
    HELD_OUT,
    SECOND,
    LabelledCorpus,
    classified,
    read_repositories,
)
from evaluation.common.function_labels import HALVES, FunctionScore, Label, read_labels, score
from evaluation.common.function_timing import Timing, timed
from evaluation.common.reliability import reliability_lines
from figures.figure import Figure
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.classifier.tables import build_tables, sum_function_nodes

PAPER_AUTOMATION = 0.8852
PAPER_PRECISION = 0.9982
_PEAK_MB = 300


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Classify what is labelled, then every corpus; then tell how well it knows what it knows."""
    labels = read_labels(datasets.corpus("labels_dev.jsonl"))
    paper, readmes = datasets.corpus("kinetic_941.jsonl"), datasets.corpus("kinetic_readme.jsonl")
    reporter.progress("labelled repositories")
    found = classified(paper, readmes)
    for half, name in enumerate(HALVES):
        yield from _half(name, score([one for one in labels if one.half == half], found))
    yield from _overall(labels, found, reporter)
    for corpus in HELD_OUT:
        reporter.progress(f"{corpus.name}: labels that the rules were not written with")
        yield from _held_out(corpus, datasets, reporter)
    reporter.progress("labels that were made later")
    yield from _second(datasets, reporter)
    yield from confidence_figures(datasets, reporter)
    nodes = sum_function_nodes(build_tables(found.values()).types)
    yield Figure("functions.941.nodes", nodes.total, 636, "functions")
    for name, file, texts, bound in (
        ("941", paper, None, 3),
        ("1232", datasets.corpus("kinetic.jsonl"), readmes, 6),
        ("humble", datasets.corpus("humble.jsonl"), None, None),
    ):
        reporter.progress(f"{file.name}, timed")
        yield from _timing(name, timed(file, texts), bound)


def _half(name: str, found: FunctionScore) -> Iterator[Figure]:
    yield Figure(f"functions.{name}.decided", found.decided, None, "share")
    yield Figure(f"functions.{name}.automation", found.automation, None, "share")
    yield Figure(f"functions.{name}.precision", found.precision, None, "share")
    yield Figure(f"functions.{name}.agreement", found.agreement, None, "share")
    yield Figure(f"functions.{name}.f1", found.f1, None, "share")


def _held_out(corpus: LabelledCorpus, datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Score a corpus by its words alone, then with what its packages depend on if that is here."""
    labels = read_labels(corpus.labels)
    by_evidence = {
        "words": read_repositories(corpus, datasets, with_depends=False),
        "depends": read_repositories(corpus, datasets),
    }
    if by_evidence["words"] == by_evidence["depends"]:
        del by_evidence["depends"]
    for evidence, repositories in by_evidence.items():
        found = {label.repo: classify(repositories[label.repo]) for label in labels}
        for half, name in enumerate(HALVES):
            scored = score([one for one in labels if one.half == half], found)
            reporter.detail([*scored.differences(), ""] if name == "develop" else [])
            yield from _half(f"{corpus.name}.{evidence}.{name}", scored)


def _second(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Score labels that were made later; how well the probabilities fit them is told, too."""
    repositories = {each.labels: read_repositories(each, datasets) for each in SECOND}
    found = FunctionScore(
        tuple(
            (label, classify(read[label.repo]))
            for path, read in repositories.items()
            for label in read_labels(path)
        )
    )
    reporter.detail([*reliability_lines("first functions, second labels", found.reliability), ""])
    yield Figure("functions.second.accuracy", found.accuracy, None, "share")
    yield Figure("functions.second.decided", found.decided, None, "share")
    yield Figure("functions.second.f1", found.f1, None, "share")
    error = found.reliability.calibration_error
    yield Figure("functions.second.calibration_error", error, None, "share")


def _overall(
    labels: tuple[Label, ...], found: Mapping[str, Classification], reporter: Reporter
) -> Iterator[Figure]:
    overall = score(labels, found)
    reporter.detail([*overall.differences(), ""])
    yield Figure(
        "functions.automation", overall.automation, PAPER_AUTOMATION, "share", at_least=0.92
    )
    yield Figure("functions.precision", overall.precision, PAPER_PRECISION, "share", at_least=0.97)
    yield Figure("functions.f1", overall.f1, None, "share", at_least=0.90)


def _timing(name: str, found: Timing, bound: float | None) -> Iterator[Figure]:
    decided = found.decided / found.repositories
    yield Figure(f"functions.{name}.decided", decided, None, "share")
    yield Figure(f"functions.{name}.time", found.seconds, None, "s", at_most=bound)
    yield Figure(f"functions.{name}.peak", found.peak, None, "MB", at_most=_PEAK_MB)
