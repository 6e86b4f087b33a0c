"""`rtron explain`."""

from typing import Annotated

import typer
from rich.markdown import Markdown
from rich.text import Text

from rtron.cli.outcome import Outcome
from rtron.cli.pages import names, pages_of, policy_pages, rule_pages
from rtron.reports.text_layout import Report, columns, line


def _complete(incomplete: str) -> list[str]:
    return [name for name in names() if name.startswith(incomplete)]


def explain(
    name: Annotated[
        str | None,
        typer.Argument(metavar="RULE|POLICY", help="What to explain.", autocompletion=_complete),
    ] = None,
) -> Outcome:
    """Explain a rule or a policy; without a name, list them.

    A scan names its rules, a plan its policies. The page says what each does,
    when to use it, and shows an example.

    $ rtron explain
    $ rtron explain gr_st
    $ rtron explain Preemption
    """
    if name is None:
        return Outcome(Report(lambda _: _listed()))
    return Outcome(Markdown("\n".join(page.text for page in pages_of(name))))


def _listed() -> list[Text]:
    rules = [(page.name, page.kind, page.summary) for page in rule_pages()]
    policies = [(page.name, page.summary) for page in policy_pages()]
    return [
        line(("Rules", "bold")),
        *columns(rules, ("cyan", "dim"), indent=2),
        line(("Policies", "bold")),
        *columns(policies, ("cyan",), indent=2),
    ]
