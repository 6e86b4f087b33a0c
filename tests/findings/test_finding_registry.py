"""Every rule of findings is registered, has its pair of graphs and its page."""

from pathlib import Path

import docs_rules
import pytest
from finding_graphs import found
from finding_pairs import PAIRS

import rtron.findings
from rtron.findings import FINDING_RULES, FindingRule, finding_page
from rtron.risks import RULES

NAMES = [rule.name for rule in FINDING_RULES]
HEADINGS = ("What it finds", "What to do", "When it is silent")
GROUPS = ("motion", "wiring")
HELPERS = {"__init__", "arbiters"}


def test_the_registry_has_every_rule_in_the_folders_once():
    root = Path(rtron.findings.__file__).parent
    files = {file.stem for group in GROUPS for file in (root / group).glob("*.py")}
    assert files - HELPERS == set(NAMES)
    assert len(NAMES) == len(set(NAMES))
    assert set(PAIRS) == set(NAMES)


def test_no_name_is_that_of_a_rule_of_the_paper():
    assert not set(NAMES) & {rule.name for rule in RULES}


@pytest.mark.parametrize("rule", FINDING_RULES, ids=NAMES)
class TestEachRule:
    def test_is_named_like_its_file(self, rule: FindingRule):
        module = rule.check.__module__
        assert module.removeprefix("rtron.findings.") in {f"{g}.{rule.name}" for g in GROUPS}

    def test_finds_its_fault_once_and_nothing_in_a_similar_graph(self, rule: FindingRule):
        faulty, sound = PAIRS[rule.name]
        (finding,) = found(rule.name, faulty)
        assert finding.id == f"{rule.name}:{finding.subject}"
        assert all((finding.subject, finding.summary, finding.cause, finding.remedy))
        assert found(rule.name, sound) == []

    def test_has_a_page_with_the_fixed_headings(self, rule: FindingRule):
        page = finding_page(rule)
        assert page.startswith(f"# {rule.title}\n\n")
        places = [page.index(f"## {heading}\n\n") for heading in HEADINGS]
        assert places == sorted(places)
        assert page.count("## ") == len(HEADINGS)
        assert f"| `{rule.name}` | {rule.consequence} | {rule.since} |" in page

    def test_its_page_in_docs_is_fresh(self, rule: FindingRule):
        page = docs_rules.PAGES / f"{rule.name}.md"
        assert page.read_text(encoding="utf-8") == finding_page(rule)
