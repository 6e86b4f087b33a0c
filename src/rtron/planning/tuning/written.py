"""A tuned plan as YAML, with the figures beside what they have changed."""

import re
from collections.abc import Iterator, Sequence
from textwrap import wrap

from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan, TuningProposal, TuningProposalKind

_WIDTH = 98
_ID = re.compile(r"( *)(?:- )?id: \"?(\w+)\"?")


def tuned_yaml(plan: Plan, proposals: Sequence[TuningProposal]) -> str:
    """Return the YAML of a plan; above a coordination node stands what a run has changed in it."""
    changed = [each for each in proposals if each.kind is TuningProposalKind.CHANGE]
    return "\n".join(_lines(write_plan(plan).split("\n"), changed))


def _lines(plan: Sequence[str], changed: Sequence[TuningProposal]) -> Iterator[str]:
    for line in plan:
        named = _ID.fullmatch(line)
        for each in changed if named else ():
            if named and each.node == named[2]:
                yield from _comment(each, named[1])
        yield line


def _comment(proposal: TuningProposal, indent: str) -> Iterator[str]:
    where = " ".join(filter(None, (proposal.flow, proposal.key)))
    text = f"{where}: {proposal.before} -> {proposal.after} ({proposal.why})"
    printable = "".join(each if each.isprintable() else "?" for each in text)
    start = f"{indent}# "
    yield from wrap(printable, _WIDTH, initial_indent=start, subsequent_indent=f"{start}  ")
