"""`rtron explain`, `rtron mission-rules` and `rtron schema`: what RTron knows, to be read."""

import sys
from dataclasses import dataclass
from difflib import get_close_matches
from enum import Enum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rtron.cli.support.outcome import Outcome, as_json
from rtron.errors import InputError, suggestion

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.text import Text

    from rtron.vocabulary import PolicyName

_LONGEST_SHOWN = 80


@dataclass(frozen=True, slots=True)
class ExplanationPage:
    """What explains a rule or a policy: its name, itself in a line, and the whole in Markdown.

    `kind` is the kind of risk that a rule finds; asking for it asks for all its rules.
    """

    name: str
    summary: str
    text: str
    kind: str = ""


def rule_pages() -> list[ExplanationPage]:
    """Return the pages of the paper's rules, in the order in which the rules run."""
    from rtron.risks import RULES, rule_page

    return [
        ExplanationPage(rule.name, rule.title, rule_page(rule.name), rule.kind) for rule in RULES
    ]


def finding_pages() -> list[ExplanationPage]:
    """Return the pages of the rules of findings, in the order in which the rules run."""
    from rtron.findings import FINDING_RULES, finding_page

    return [ExplanationPage(rule.name, rule.title, finding_page(rule)) for rule in FINDING_RULES]


def policy_pages() -> list[ExplanationPage]:
    """Return the pages of the policies that a plan can choose."""
    from rtron.policies import POLICIES

    return [_policy_page(name) for name in POLICIES]


def page_names() -> list[str]:
    """Return every name that can be explained."""
    return [page.name for page in _pages()]


def find_pages(name: str) -> list[ExplanationPage]:
    """Return the pages of a rule, a kind, a policy, or the id of a finding or a risk.

    Raise InputError for others.
    """
    normalised = _normalise(name.partition(":")[0])
    found = [
        page for page in _pages() if normalised in (_normalise(page.name), _normalise(page.kind))
    ]
    if not found:
        raise _unknown_name(name[:_LONGEST_SHOWN])
    return found


def _pages() -> list[ExplanationPage]:
    return [*finding_pages(), *rule_pages(), *policy_pages()]


def _policy_page(name: "PolicyName") -> ExplanationPage:
    from rtron.policies import POLICIES

    docstring = (sys.modules[POLICIES[name].__module__].__doc__ or "").strip()
    title, _, text = docstring.partition("\n")
    summary = title.removeprefix(f"{name}: ")
    return ExplanationPage(str(name), summary, f"# {name}\n\n{summary}\n{text}\n")


def _normalise(name: str) -> str:
    return name.lower().replace("-", "_")


def _unknown_name(name: str) -> InputError:
    known = {_normalise(known): known for known in page_names()}
    near = get_close_matches(_normalise(name), known, n=1)
    help = f"did you mean {known[near[0]]}? " if near else ""
    return InputError(
        f"no rule and no policy is named {name!r}", help=f"{help}`rtron explain` lists all"
    )


def _complete_name(incomplete: str) -> list[str]:
    return [name for name in page_names() if name.startswith(incomplete)]


def explain(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="RULE|POLICY", help="The rule or policy.", autocompletion=_complete_name
        ),
    ] = None,
) -> Outcome:
    """Explain a rule or a policy; without a name, list them.

    A scan names its rules, a plan its policies. A page says what a rule or a
    policy does and when to use it, with an example.

    $ rtron explain
    $ rtron explain several_publishers
    $ rtron explain gr_st
    $ rtron explain Preemption
    """
    from rich.markdown import Markdown

    from rtron.reports.text_layout import Report

    if name is None:
        return Outcome(Report(lambda _: _list_pages()))
    return Outcome(Markdown("\n".join(page.text for page in find_pages(name))))


def _list_pages() -> "list[Text]":
    from rtron.reports.text_layout import columns, line

    findings = [(page.name, page.summary) for page in finding_pages()]
    rules = [(page.name, page.kind, page.summary) for page in rule_pages()]
    policies = [(page.name, page.summary) for page in policy_pages()]
    return [
        line(("Findings", "bold")),
        *columns(findings, ("cyan",), indent=2),
        line(("The paper's risks", "bold")),
        *columns(rules, ("cyan", "dim"), indent=2),
        line(("Policies", "bold")),
        *columns(policies, ("cyan",), indent=2),
    ]


def _complete_mission(incomplete: str) -> list[str]:
    from rtron.planning.missions import MISSIONS

    return [name for name in MISSIONS if name.startswith(incomplete)]


def mission_rules(
    name: Annotated[
        str | None,
        typer.Argument(metavar="NAME", help="The mission.", autocompletion=_complete_mission),
    ] = None,
) -> Outcome:
    """Show example rules for a robot's mission; without a name, list them.

    Each is a complete plan: events, their meaning, and the actions that they
    forbid. Copy its rules.

    $ rtron mission-rules
    $ rtron mission-rules recharge
    $ rtron mission-rules recharge > rtron.yaml && rtron check rtron.yaml
    """
    from rtron.planning.missions import MISSIONS, mission_text
    from rtron.reports.text_layout import Report

    if name is None:
        return Outcome(Report(lambda _: _list_missions()))
    if name not in MISSIONS:
        raise InputError(f"no mission {name}", help=suggestion(name, MISSIONS))
    return Outcome(mission_text(name))


def _list_missions() -> "list[Text]":
    from rtron.planning.missions import MISSIONS, mission_summary
    from rtron.reports.text_layout import columns, line

    rows = [(name, mission_summary(name)) for name in MISSIONS]
    return [line(("Missions", "bold")), *columns(rows, ("cyan",), indent=2)]


class Document(str, Enum):
    """A document that RTron reads."""

    PLAN = "plan"
    GRAPH = "graph"
    CONFIG = "config"
    BRIDGE = "bridge"


def schema(
    document: Annotated[Document, typer.Argument(help="The document to describe.")],
) -> Outcome:
    """Print the JSON Schema of a plan, graph, configuration, or bridge.

    These are rtron.yaml, graph.json, rtron.toml and bridge.yaml. Give the schema
    to your editor: it then completes and checks the file while you write. A plan
    that `rtron plan` proposes names its schema, and editors with the YAML
    language server find it.

    $ rtron schema plan > rtron.schema.json
    """
    from rtron.bridge.rights.document import rights_json_schema
    from rtron.planning.plan_file.json_schema import plan_json_schema
    from rtron.sources.graph_json import graph_json_schema
    from rtron.sources.ignores import config_json_schema
    from rtron.workflows.scan import RULE_NAMES

    schemas: dict[Document, Callable[[], dict[str, Any]]] = {
        Document.PLAN: plan_json_schema,
        Document.GRAPH: graph_json_schema,
        Document.CONFIG: lambda: config_json_schema(RULE_NAMES),
        Document.BRIDGE: rights_json_schema,
    }
    return Outcome(as_json(schemas[document]()))
