"""Every rule is registered, has its pair of apps and its page, and explains itself."""

from pathlib import Path

import docs_rules
import pytest
from docs_files import stale
from notation import graph_of
from rule_pairs import PAIRS

import rtron.risks
from rtron.errors import InputError
from rtron.findings import FINDING_RULES
from rtron.risks import RULES, RiskRule, discover_risks, rule_page
from rtron.vocabulary import InteractionGraph

NAMES = [rule.name for rule in RULES]
HEADINGS = ("What it finds", "What to do", "When it is silent")


def test_the_registry_has_every_rule_in_the_folder_once():
    files = Path(rtron.risks.__file__).parent.glob("*.py")
    rules = {file.stem for file in files if file.stem.startswith(("gr_", "rsr_", "msr_"))}
    assert rules == set(NAMES)
    assert len(NAMES) == len(set(NAMES))


@pytest.mark.parametrize("rule", RULES, ids=NAMES)
class TestEachRule:
    def test_is_named_like_its_file(self, rule: RiskRule):
        assert rule.check.__module__ == f"rtron.risks.{rule.name}"

    def test_finds_its_risk_and_nothing_beside_it(self, rule: RiskRule):
        risky, safe = (graph_of("pair", text) for text in PAIRS[rule.name])
        found = [risk for risk in discover_risks(risky).risks if risk.rule == rule.name]
        assert len(found) == 1
        assert found[0].kind is rule.kind
        assert [risk for risk in discover_risks(safe).risks if risk.rule == rule.name] == []
        assert rule.name not in discover_risks(safe).not_run

    def test_has_a_page_with_the_fixed_headings(self, rule: RiskRule):
        page = rule_page(rule.name)
        places = [page.index(f"## {heading}\n") for heading in HEADINGS]
        assert places == sorted(places)
        assert page.count("## ") == len(HEADINGS)

    def test_says_where_its_severity_comes_from_and_since_when_it_is_there(self, rule: RiskRule):
        assert rule.severity
        assert rule.since.count(".") == 2

    def test_says_that_it_could_not_run(self, rule: RiskRule):
        assert "the graph holds no" in discover_risks(InteractionGraph(app="")).not_run[rule.name]


def test_the_pages_in_docs_are_fresh(tmp_path):
    assert stale(docs_rules.documents()) == {}
    number = len(RULES) + len(FINDING_RULES) + 1
    assert len(stale(docs_rules.documents(tmp_path))) == number
    assert len(list(docs_rules.PAGES.iterdir())) == number


@pytest.mark.parametrize("name", ["gr_st", "GR-ST", "Gr_St"])
def test_a_rule_is_explained_under_its_name_or_kind(name):
    assert rule_page(name).startswith("# General risk with a single topic")


@pytest.mark.parametrize(("name", "nearest"), [("gr_sr", "gr_st"), ("max_vel", "rsr_max_vel")])
def test_an_unknown_rule_names_the_nearest(name, nearest):
    with pytest.raises(InputError, match="no rule") as caught:
        rule_page(name)
    assert caught.value.help == f"did you mean {nearest}?"


def test_a_rule_like_none_lists_them_all():
    with pytest.raises(InputError) as caught:
        rule_page("x" * 10_000)
    assert all(name in caught.value.help for name in NAMES)
    assert len(str(caught.value)) < 200
