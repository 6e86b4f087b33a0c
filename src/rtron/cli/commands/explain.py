"""`rtron explain`."""

from typing import Annotated

import typer
from rich.markdown import Markdown
from rich.text import Text

from rtron.cli.pages import find_pages, page_names, policy_pages, rule_pages
from rtron.cli.support.outcome import Outcome
from rtron.reports.lines import Report, columns, line


def _complete_name(incomplete: str) -> list[str]:
    return [name for name in page_names() if name.startswith(incomplete)]


def explain(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="RULE|POLICY", help="What to explain.", autocompletion=_complete_name
        ),
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
        return Outcome(Report(lambda _: _list_pages()))
    return Outcome(Markdown("\n".join(page.text for page in find_pages(name))))


def _list_pages() -> list[Text]:
    rules = [(page.name, page.kind, page.summary) for page in rule_pages()]
    policies = [(page.name, page.summary) for page in policy_pages()]
    return [
        line(("Rules", "bold")),
        *columns(rules, ("cyan", "dim"), indent=2),
        line(("Policies", "bold")),
        *columns(policies, ("cyan",), indent=2),
    ]
