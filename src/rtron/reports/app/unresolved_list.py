"""What a scan was not given, and what it could not read, by what to do about it."""

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from shlex import quote

from rich.text import Text

from rtron.reports.app.note_groups import group_notes
from rtron.reports.app.risk_list import location
from rtron.reports.text_layout import TextPage, heading, line, paragraph
from rtron.vocabulary import InteractionGraph, UnresolvedItem

MOST_CAUSES = 3
"""Causes that are told of a kind of notes."""
_MOST_EXAMPLES = 3
_VARIABLE, _ARGUMENT = "environment variable ", "launch argument "
_PACKAGE = re.compile(r"package '([^']+)' is not (?:here|found)")
_OF_NODE = re.compile(r"\((\w+)/[^)]*\)$")
_NO_SOURCE = ("its package is not here", "no source of it is here")
_MOST_NAMES = 6


def missing_inputs(graph: InteractionGraph) -> Iterator[str]:
    """Yield a line for each kind of input that is missing, with how to give it."""
    unresolved = graph.unresolved
    if packages := _packages(unresolved):
        yield (
            f"not here: {_names('package', packages)}; "
            "give the folders of their source too: rtron scan PATH PATH…"
        )
    if files := [each.missing for each in unresolved if _is_include(each)]:
        yield (
            f"not here: {_names('launch file', files)}; "
            "give the folder that has it, or correct the include"
        )
    if variables := _named(unresolved, _VARIABLE):
        first = quote(variables[0])
        yield (
            f"not given: {_names('environment variable', variables)}; "
            f"--env {first} takes your own value, --env {first}=VALUE another, --env-all all"
        )
    for each in unresolved:
        if each.what.startswith(_ARGUMENT):
            yield f"{each.what}: {each.why}"


def _packages(unresolved: Sequence[UnresolvedItem]) -> list[str]:
    named = [match[1] for each in unresolved for match in _PACKAGE.finditer(each.why)]
    nodes = [each.what for each in unresolved if each.why.startswith(_NO_SOURCE)]
    return [*named, *(match[1] for what in nodes if (match := _OF_NODE.search(what)))]


def _is_include(item: UnresolvedItem) -> bool:
    return bool(item.missing) and item.what.startswith("include")


def _named(unresolved: Sequence[UnresolvedItem], start: str) -> list[str]:
    return [each.what.removeprefix(start) for each in unresolved if each.what.startswith(start)]


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
    for group in group_notes(unresolved):
        yield line((f"{group.kind.title} ({len(group.notes)})", "bold"), indent=2)
        yield from paragraph(f"-> {group.kind.remedy}", page, indent=4, style="green")
        yield from _causes(group.notes, page) if group.kind.has_causes else ()


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
