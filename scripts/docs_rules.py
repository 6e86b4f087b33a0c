"""Write docs/rules/<name>.md and their index from the rules' docstrings.

With --check, write nothing, name the pages that are stale and exit 1 if there are any.
"""

import argparse
import sys
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


def stale(pages: Path) -> dict[Path, str]:
    """Return what should stand in each page that does not."""
    wanted = {pages / f"{rule.name}.md": rule_page(rule.name) for rule in RULES}
    wanted |= {pages / f"{rule.name}.md": finding_page(rule) for rule in FINDING_RULES}
    wanted[pages / "README.md"] = index()
    return {
        path: page
        for path, page in wanted.items()
        if not path.exists() or path.read_text(encoding="utf-8") != page
    }


def main() -> int:
    """Write the stale pages, or name them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing, exit 1 if stale")
    check = parser.parse_args().check
    found = stale(PAGES)
    for path, page in found.items():
        if check:
            print(f"{path} is stale: run scripts/docs_rules.py", file=sys.stderr)
        else:
            path.write_text(page, encoding="utf-8")
    return 1 if check and found else 0


if __name__ == "__main__":
    sys.exit(main())
