"""The page of a rule: one text for `rtron explain`, the docs and reports."""

from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module

from rtron.errors import InputError
from rtron.risks.rule import Rule

HEADINGS = ("What it finds", "Why it is a risk", "Remedy", "Example")


def page(rule: Rule) -> str:
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


def named(rules: Sequence[Rule], name: str) -> Rule:
    """Return the rule of that name (`gr_st` or `GR-ST`); raise InputError if there is none."""
    known = {rule.name: rule for rule in rules}
    wanted = name.lower().replace("-", "_")
    if wanted in known:
        return known[wanted]
    near = get_close_matches(wanted[:80], known, n=1, cutoff=0.3)
    help = f"did you mean {near[0]}?" if near else f"the rules are {', '.join(known)}"
    raise InputError(f"no rule is named {name[:80]!r}", help=help)
