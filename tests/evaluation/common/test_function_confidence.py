"""How well the classifier knows how sure it is."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from evaluation.common.datasets import Datasets, MissingDatasetError
from evaluation.common.function_confidence import (
    POSITIONS,
    Answer,
    cross_validated,
    held_out_answers,
    labelled_answers,
    learned_weights,
)
from evaluation.common.function_corpora import HELD_OUT, SECOND, LabelledCorpus, read_repositories
from evaluation.common.function_labels import Label, read_labels
from evaluation.common.reliability import reliability
from rtron.functions.classifier.scores import FEATURES
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.vocabulary import FunctionType

T = FunctionType
DATA = os.environ.get("RTRON_DATA")


def answer(repo, share, right, position="first"):
    features = (1.0, share, 1.0, 0.0)
    return Answer(repo=repo, view="all", position=position, features=features, right=right)


def answers():
    """Of those with much evidence nine in ten are right, of those with little one in two."""
    sure = [answer(f"sure{n}", 0.9, float(n % 10 > 0), p) for n in range(100) for p in POSITIONS]
    return sure + [answer(f"weak{n}", 0.1, float(n % 2), p) for n in range(100) for p in POSITIONS]


def test_probabilities_are_learned_from_other_repositories():
    found = answers()
    probabilities = cross_validated(found)
    sure = [p for each, p in zip(found, probabilities, strict=True) if each.repo.startswith("sure")]
    weak = [p for each, p in zip(found, probabilities, strict=True) if each.repo.startswith("weak")]
    assert np.mean(sure) == pytest.approx(0.9, abs=0.05)
    assert np.mean(weak) == pytest.approx(0.5, abs=0.05)
    changed = [
        answer("sure1", 0.9, 0.0, each.position) if each.repo == "sure1" else each for each in found
    ]
    at = next(at for at, each in enumerate(found) if each.repo == "sure1")
    assert cross_validated(changed)[at] == probabilities[at]


def test_the_weights_have_the_names_of_the_features():
    weights = learned_weights(answers())
    assert set(weights) == set(POSITIONS)
    assert all(tuple(each) == FEATURES for each in weights.values())
    assert weights["first"]["share"] > 0


def test_the_reliability():
    probabilities = np.array([0.75, 0.75, 0.75, 0.75, 1.0, 0.92])
    right = np.array([1.0, 1.0, 1.0, 0.0, 1.0, 0.5])
    found = reliability(probabilities, right)
    assert found.answers == sum(each.answers for each in found.bins) == 6
    assert found.brier == pytest.approx((3 * 0.0625 + 0.5625 + 0.42**2) / 6)
    assert found.base == pytest.approx(np.var(right))
    assert found.calibration_error == pytest.approx(0.42 / 6)
    assert [(each.answers, each.right) for each in found.bins] == [(4, 0.75), (1, 0.5), (1, 1.0)]


def test_a_repository_is_also_asked_without_its_readme_and_by_its_names_alone():
    repository = SourceRepository(
        name="grid_mapping",
        packages=(SourcePackage(name="grid_mapping", description="Builds maps."),),
        readme="A driver for a camera.",
    )
    label = Label(
        repo="grid_mapping",
        primary=frozenset({T.MAPPING, T.SENSORS}),
        functions=frozenset({T.MAPPING}),
        accepted=frozenset(),
    )
    found = list(labelled_answers([label], {"grid_mapping": repository}))
    assert [each.view for each in found] == ["all", "manifests", "names"]
    assert {each.position for each in found} == {"first"}
    assert {each.right for each in found} == {0.5}
    assert found[0].features != found[1].features != found[2].features


def test_what_packages_depend_on_is_added(tmp_path):
    corpus = tmp_path / "corpus"
    corpus.mkdir()
    line = {"repo": "r", "packages": [{"name": "p"}, {"name": "q", "depends": ["own"]}]}
    (corpus / "c.jsonl").write_text(json.dumps(line))
    labelled = LabelledCorpus(
        name="x", labels=tmp_path, repositories="c.jsonl", depends="depends.jsonl"
    )
    datasets = Datasets(None, tmp_path)

    def depends(**keys):
        packages = read_repositories(labelled, datasets, **keys)["r"].packages
        return [package.depends for package in packages]

    assert depends() == [(), ("own",)]
    (corpus / "depends.jsonl").write_text(json.dumps({"package": "p", "depends": ["joy"]}))
    assert depends() == [("joy",), ("own",)]
    assert depends(with_depends=False) == [(), ("own",)]


def test_without_a_corpus_it_is_said():
    with pytest.raises(MissingDatasetError):
        held_out_answers(Datasets(None, None))


@pytest.mark.parametrize("path", sorted(HELD_OUT[0].labels.parent.glob("function_labels*.jsonl")))
def test_the_labels_are_whole(path):
    labels = read_labels(path)
    assert len({label.repo for label in labels}) == len(labels) >= 50
    for label in labels:
        assert 1 <= len(label.primary) <= 2
        assert label.primary <= label.functions | label.accepted
        assert not label.functions & label.accepted


@pytest.mark.skipif(DATA is None, reason="RTRON_DATA names no folder with corpus/")
def test_no_label_is_one_that_the_rules_were_written_with():
    written_with = {each.repo for each in read_labels(Path(DATA, "corpus/labels_dev.jsonl"))}
    for corpus in (*HELD_OUT, *SECOND):
        assert not written_with & {label.repo for label in read_labels(corpus.labels)}
