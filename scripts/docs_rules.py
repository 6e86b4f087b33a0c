"""The text of docs/rules/<name>.md and their index from the rules' docstrings."""

from pathlib import Path

from rtron.findings import FINDING_RULES, FindingRule, finding_page
from rtron.findings import severity as finding_severity
from rtron.risks import RULES, RiskRule, rule_page, severity
from rtron.risks.list_parser import TABLES, WORD_LISTS

PAGES = Path(__file__).parent.parent / "docs" / "rules"


INDEX = """\
# Rules

What `rtron scan` looks for, one page a rule. `rtron explain RULE` prints the page.

## Findings

[`--level`](../findings.md#levels) chooses how many `rtron scan` shows.

| rule | what it finds |
|---|---|
{findings}

## Severity of findings

{finding_severity}

## The paper's risks

`rtron scan --level auditor` shows them.

| rule | what it finds |
|---|---|
{rules}

## Your own words

`rtron scan --name-lists FILE` adds your words to these lists of `src/rtron/risks/data/`:

{lists}

## Severity of risks

{severity}
"""


def index() -> str:
    """Return the index of the rules in Markdown."""
    return INDEX.format(
        findings="\n".join(map(_finding_row, FINDING_RULES)),
        finding_severity=(finding_severity.__doc__ or "").strip(),
        rules="\n".join(map(_row, RULES)),
        lists=", ".join(f"`{name}`" for name in (*WORD_LISTS, *TABLES)),
        severity=(severity.__doc__ or "").strip(),
    )


def _row(rule: RiskRule) -> str:
    return f"| [{rule.name}]({rule.name}.md) | {rule.title} |"


def _finding_row(rule: FindingRule) -> str:
    return f"| [{rule.name}]({rule.name}.md) | {rule.title} |"


def documents(pages: Path = PAGES) -> dict[Path, str]:
    """Return what stands in each page."""
    found = {pages / f"{rule.name}.md": rule_page(rule.name) for rule in RULES}
    found |= {pages / f"{rule.name}.md": finding_page(rule) for rule in FINDING_RULES}
    return {**found, pages / "README.md": index()}
