"""The text of docs/policies/<Name>.md from each policy's docstring and table, and their index."""

from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

from rtron.policies import POLICIES, Policy
from rtron.policies.state_machine import TableEnum, TransitionEffect, TransitionTable
from rtron.vocabulary import PolicyName, PolicySettings

PAGES = Path(__file__).parent.parent / "docs" / "policies"
_EXAMPLE = "## Example\n\n"

INDEX = """\
# Policies

What a coordination node does with each message is its policy. `rtron explain NAME` prints its
page. [Leases](../leases.md) and [limits of the velocity](../missions.md) show plans.

| policy | what it does |
|---|---|
{rows}
"""


def index() -> str:
    """Return the index of the policies in Markdown."""
    return INDEX.format(rows="\n".join(map(_row, POLICIES.items())))


def _row(item: tuple[PolicyName, Callable[[PolicySettings], Policy]]) -> str:
    name, policy = item
    return f"| [{name}]({name}.md) | {_summary(name, import_module(policy.__module__))} |"


def _summary(name: PolicyName, module: ModuleType) -> str:
    summary = (module.__doc__ or "").strip().split("\n", 1)[0].removeprefix(f"{name}: ")
    return f"{summary[0].upper()}{summary[1:]}"


def policy_page(name: PolicyName, policy: Callable[[PolicySettings], Policy]) -> str:
    """Return a policy's page in Markdown."""
    module = import_module(policy.__module__)
    _, text = (module.__doc__ or "").strip().split("\n", 1)
    text, _ = text.split(_EXAMPLE)
    first = _first_with(module.TABLE)
    others = f"The states and transitions are those of [{first}]({first}.md#states)."
    states = "\n".join(_states(module.TABLE)) if first == name else others
    return f"# {name}\n\n{_summary(name, module)}\n{text}{states}\n"


def _first_with(table: TransitionTable[TableEnum, TableEnum]) -> PolicyName:
    """Return the first policy that has this table."""
    return next(
        name for name, policy in POLICIES.items() if import_module(policy.__module__).TABLE is table
    )


def _states(table: TransitionTable[TableEnum, TableEnum]) -> Iterator[str]:
    """Yield the states, and a row for each transition that can arise and does something."""
    states = tuple(dict.fromkeys(state for state, _ in table))
    for state in states:
        yield f"- **{state.name}**: {state.value}"
    yield "\n| what happens | state | next state | effect |\n|---|---|---|---|"
    for happens in dict.fromkeys(happens for _, happens in table):
        rows = {
            state: table[state, happens]
            for state in states
            if table[state, happens] != (state, TransitionEffect.NOTHING)
            and table[state, happens][1] is not TransitionEffect.NEVER
        }
        for names, after, effect in _merged(rows, len(states)):
            yield f"| {happens.value} | {names} | {after} | {effect.value} |"


def _merged(
    rows: dict[TableEnum, tuple[TableEnum, TransitionEffect]], number: int
) -> Iterator[tuple[str, str, TransitionEffect]]:
    """Yield one row for all states of which one row tells the same, else each."""
    effects = {effect for _, effect in rows.values()}
    names = "any" if len(rows) == number > 1 else ", ".join(state.name for state in rows)
    if len(effects) == 1 and all(after is state for state, (after, _) in rows.items()):
        yield names, "the same", effects.pop()
    elif len(set(rows.values())) == 1:
        yield names, next(iter(rows.values()))[0].name, effects.pop()
    else:
        for state, (after, effect) in rows.items():
            yield state.name, after.name, effect


def documents(pages: Path = PAGES) -> dict[Path, str]:
    """Return what stands in each page."""
    found = {pages / f"{name}.md": policy_page(name, made) for name, made in POLICIES.items()}
    return {**found, pages / "README.md": index()}
