"""What docs/functions.md says is so."""

import re
from pathlib import Path

import pytest
from function_examples import failing_examples

from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import DecisionSource
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.functions.rules.loader import parse_rules
from rtron.vocabulary import Domain, FunctionType

PAGE = (Path(__file__).parents[2] / "docs" / "functions.md").read_text(encoding="utf-8")


def test_its_rule_is_one_and_does_what_it_says():
    (text,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    (rule,) = parse_rules(text, "page", {})
    assert list(failing_examples([rule])) == []
    assert rule.vetoes


def test_its_types_are_all_there_are():
    rows = re.findall(r"^\| (\w+) \| (.+) \|$", PAGE, re.MULTILINE)
    told = {
        FunctionType(type): Domain(domain)
        for domain, types in rows
        if domain in {*Domain}
        for type in types.split(", ")
    }
    assert told == DOMAIN_BY_TYPE


@pytest.mark.parametrize(
    "text",
    ["\n\n" * 32_000, ("\n" + " ") * 32_000, "![" * 32_000, "# " * 32_000, " " * 64_000 + "x"],
    ids=["lines", "blanks", "images", "headings", "spaces"],
)
def test_a_readme_of_signs_only_tells_nothing(text):
    package = SourcePackage(name="qqq", description=text)
    found = classify(SourceRepository(name="zzz", packages=(package,), readme=text))
    assert found.decided_by is DecisionSource.NONE
    assert found.evidence == ()
