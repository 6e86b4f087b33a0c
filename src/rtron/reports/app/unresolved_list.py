"""What a scan was not given, and what it could not read, by what to do about it."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from shlex import quote

from rich.text import Text

from rtron.reports.app.note_groups import group_notes
from rtron.reports.app.risk_list import location
from rtron.reports.text_layout import TextPage, heading, line, paragraph
from rtron.vocabulary import InteractionGraph, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.enums import HiddenPart

MOST_CAUSES = 3
"""Causes that are told of a kind of notes."""
_MOST_EXAMPLES = 3
_MOST_NAMES = 6


def missing_inputs(graph: InteractionGraph) -> Iterator[str]:
    """Yield a line for each kind of input that is missing, with how to give it."""
    unresolved = graph.unresolved
    not_here = [each for each in unresolved if each.cause is UnresolvedCause.MISSING_SOURCE]
    if packages := sorted({each.package for each in not_here} - {""}):
        yield (
            f"not here: {_names('package', packages)}; "
            "give the folders of their source too: rtron scan PATH PATH…"
        )
    if files := [e.missing for e in unresolved if e.missing and e.hides is HiddenPart.NODES]:
        yield (
            f"not here: {_names('launch file', files)}; "
            "give the folder that has it, or correct the include"
        )
    unset = [each for each in unresolved if each.cause is UnresolvedCause.UNSET_VARIABLE]
    if variables := [each.what.rpartition(" ")[2] for each in unset]:
        first = quote(variables[0])
        yield (
            f"not given: {_names('environment variable', variables)}; "
            f"--env {first} takes your own value, --env {first}=VALUE another, --env-all all"
        )
    for each in unresolved:
        if each.cause is UnresolvedCause.ARGUMENT:
            yield f"{each.what}: {each.why}"


def _names(noun: str, names: Sequence[str]) -> str:
    """Return the names once each, with their noun; of many the first."""
    unique = list(dict.fromkeys(names))
    more = f" and {len(unique) - _MOST_NAMES} more" if len(unique) > _MOST_NAMES else ""
    plural = "" if len(unique) == 1 else "s"
    return f"{noun}{plural} {', '.join(unique[:_MOST_NAMES])}{more}"


def nodes_read(graph: InteractionGraph) -> str:
    """Return how many nodes were read, where some were not, and what to do where none was."""
    unread = [node for node in graph.nodes if node.unread]
    if not unread:
        return ""
    names = ", ".join(node.name for node in unread[:_MOST_EXAMPLES])
    more = f" and {len(unread) - _MOST_EXAMPLES} more" if len(unread) > _MOST_EXAMPLES else ""
    read = len(graph.nodes) - len(unread)
    remedy = (
        ""
        if read
        else (
            "; nothing can be found in them: correct what is listed as not resolved, or give its "
            "source, and scan again"
        )
    )
    return f"{read} of {len(graph.nodes)} nodes read; not read: {names}{more}{remedy}"


def unresolved_list(unresolved: Sequence[UnresolvedItem], page: TextPage) -> Iterator[Text]:
    """Yield each kind of notes with what to do about it, and its most frequent causes."""
    if unresolved:
        yield from heading(f"Not resolved ({len(unresolved)})")
    for kind, notes in group_notes(unresolved):
        yield line((f"{kind.title} ({len(notes)})", "bold"), indent=2)
        yield from paragraph(f"-> {kind.remedy}", page, indent=4, style="green")
        yield from _causes(notes, page) if kind.has_causes else ()


def _causes(notes: Sequence[UnresolvedItem], page: TextPage) -> Iterator[Text]:
    causes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in notes:
        causes[note.why].append(note)
    ordered = sorted(causes, key=lambda why: -len(causes[why]))
    for why in ordered[:MOST_CAUSES]:
        yield from _cause(why, causes[why], page)
    if rest := sum(len(causes[why]) for why in ordered[MOST_CAUSES:]):
        yield line((f"and {rest} more, which --format graph lists", "dim"), indent=4)


def _cause(why: str, items: Sequence[UnresolvedItem], page: TextPage) -> Iterator[Text]:
    first = items[0]
    at = f" ({location(first.evidence[0])})" if first.evidence else ""
    names = list(dict.fromkeys(item.what for item in items))
    more = f" and {len(names) - _MOST_EXAMPLES} more" if len(names) > _MOST_EXAMPLES else ""
    yield from paragraph(f"{'; '.join(names[:_MOST_EXAMPLES])}{more}: {why}{at}", page, indent=4)
