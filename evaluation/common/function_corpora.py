"""Corpora of repositories: classified, and with labels that the rules were not written with."""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from evaluation.common.datasets import Datasets, MissingDatasetError
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.reading.repositories import read_corpus, read_readmes
from rtron.functions.repository import SourceRepository

_DATA = Path(__file__).parents[1] / "data"


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledCorpus:
    """Labels by hand, the file of `corpus/` that describes their repositories, and what adds to it.

    `depends` has a line `{"package", "depends"}` for each package whose manifest is known.
    """

    name: str
    labels: Path
    repositories: str
    readmes: str = ""
    depends: str = ""


HELD_OUT = (
    LabelledCorpus(
        name="heldout",
        labels=_DATA / "function_labels.jsonl",
        repositories="kinetic_941.jsonl",
        readmes="kinetic_readme.jsonl",
        depends="kinetic_depends.jsonl",
    ),
    LabelledCorpus(
        name="heldout_ros2",
        labels=_DATA / "function_labels_ros2.jsonl",
        repositories="humble.jsonl",
        depends="humble_depends.jsonl",
    ),
)

SECOND = (
    LabelledCorpus(
        name="second",
        labels=_DATA / "function_labels_second.jsonl",
        repositories="kinetic.jsonl",
        readmes="kinetic_readme.jsonl",
    ),
    LabelledCorpus(
        name="second_ros2",
        labels=_DATA / "function_labels_second_ros2.jsonl",
        repositories="humble.jsonl",
    ),
)
"""Labels made and measured later: what docs/functions.md says of them was measured before any rule
was corrected with them."""


def read_repositories(
    corpus: LabelledCorpus, datasets: Datasets, *, with_depends: bool = True
) -> Mapping[str, SourceRepository]:
    """Return the repositories of a corpus by name; raise MissingDatasetError if it is not here.

    What their packages depend on is told where the file of it is here.
    """
    readmes = (
        read_readmes(datasets.corpus(corpus.readmes), ignore_skipped) if corpus.readmes else {}
    )
    depends = _read_depends(corpus, datasets) if with_depends else {}
    found = read_corpus(datasets.corpus(corpus.repositories), ignore_skipped)
    return {
        each.name: replace(_with_depends(each, depends), readme=readmes.get(each.name, each.readme))
        for each in found
    }


def classified(corpus: Path, readmes: Path | None = None) -> Mapping[str, Classification]:
    """Return the classification of every repository of a corpus."""
    texts = read_readmes(readmes, ignore_skipped) if readmes else {}
    repositories = read_corpus(corpus, ignore_skipped)
    with_readmes = (
        replace(each, readme=texts.get(each.name, each.readme)) for each in repositories
    )
    return {each.name: classify(each) for each in with_readmes}


def ignore_skipped(*_: object) -> None:
    """Take what is wrong with a line of a corpus."""


def _read_depends(corpus: LabelledCorpus, datasets: Datasets) -> Mapping[str, tuple[str, ...]]:
    try:
        lines = datasets.corpus(corpus.depends).read_text(encoding="utf-8").splitlines()
    except MissingDatasetError:
        return {}
    return dict(_depends_entries(lines))


def _depends_entries(lines: Iterable[str]) -> Iterator[tuple[str, tuple[str, ...]]]:
    for line in lines:
        document = json.loads(line)
        yield document["package"], tuple(document["depends"])


def _with_depends(
    repository: SourceRepository, depends: Mapping[str, tuple[str, ...]]
) -> SourceRepository:
    packages = tuple(
        replace(package, depends=depends.get(package.name, package.depends))
        for package in repository.packages
    )
    return replace(repository, packages=packages)
