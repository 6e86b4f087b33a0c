"""The rules beside a corpus of repositories, where RTRON_DATA names one."""

import os
from collections import Counter
from pathlib import Path

import pytest

from evaluation.common.function_corpora import classified
from evaluation.common.function_labels import read_labels, score
from rtron.functions.classifier.rule_trace import trace_rules
from rtron.functions.reading.repositories import read_corpus, read_readmes
from rtron.functions.rules.loader import load_rules

CORPUS = Path(os.environ.get("RTRON_DATA", "")) / "corpus"
KINETIC, READMES = CORPUS / "kinetic_941.jsonl", CORPUS / "kinetic_readme.jsonl"

pytestmark = pytest.mark.skipif(
    "RTRON_DATA" not in os.environ, reason="RTRON_DATA names no folder with corpus/"
)


def ignore(*_):
    pass


def test_no_rule_is_for_one_repository():
    repositories = Counter()
    for repository in read_corpus(KINETIC, ignore):
        repositories.update(
            {found.rule for found in trace_rules(repository) if not found.is_vetoed}
        )
    assert [rule.id for rule in load_rules() if repositories[rule.id] < 2] == []


def test_the_labelled_repositories_are_classified_well():
    found = classified(KINETIC, READMES)
    whole = score(read_labels(CORPUS / "labels_dev.jsonl"), found)
    assert len(whole.pairs) == 180
    assert whole.automation >= 0.92
    assert whole.precision >= 0.97
    assert whole.f1 >= 0.90


def test_a_readme_changes_only_what_nothing_else_decides():
    with_readmes, without = classified(KINETIC, READMES), classified(KINETIC)
    assert read_readmes(READMES, ignore)
    for name, found in without.items():
        if found.primary is not None:
            assert with_readmes[name].primary is found.primary
