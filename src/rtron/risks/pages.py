"""The page of a rule: one text for `rtron explain`, the docs and reports."""

from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module

from rtron.errors import InputError
from rtron.risks.rule import RiskRule

HEADINGS = ("What it finds", "Why it is a risk", "Remedy", "Example")


def format_rule_page(rule: RiskRule) -> str:
    """Return a rule's page in Markdown: its title, its facts and its module's docstring."""
    docstring = import_module(rule.check.__module__).__doc__ or ""
    summary, text = docstring.strip().split("\n", 1)
    needs = ", ".join(map(str, rule.needs))
    return (
        f"# {rule.title}\n\n{summary}\n\n"
        f"| rule | kind | severity | needs | since |\n|---|---|---|---|---|\n"
        f"| `{rule.name}` | {rule.kind} | {rule.severity} | {needs} | {rule.since} |\n"
        f"{text}\n"
    )


def find_rule(rules: Sequence[RiskRule], name: str) -> RiskRule:
    """Return the rule of that name (`gr_st` or `GR-ST`); raise InputError if there is none."""
    known = {rule.name: rule for rule in rules}
    rule_name = name.lower().replace("-", "_")
    if rule_name in known:
        return known[rule_name]
    near = get_close_matches(rule_name[:80], known, n=1, cutoff=0.3)
    help = f"did you mean {near[0]}?" if near else f"the rules are {', '.join(known)}"
    raise InputError(f"no rule is named {name[:80]!r}", help=help)
