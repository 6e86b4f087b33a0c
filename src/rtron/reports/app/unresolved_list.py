"""What a scan could not read, grouped by its cause, with what to do about it."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

from rich.text import Text

from rtron.reports.app.risk_list import location
from rtron.reports.text_layout import TextPage, heading, line, paragraph
from rtron.vocabulary import InteractionGraph, UnresolvedItem

MOST_CAUSES = 10
_MOST_EXAMPLES = 3
_REMEDIES: Mapping[str, str] = {
    "no source of it is here, and no model": "give the folder of its source, or write a model: "
    "`rtron model draft`",
    "its package is not here: give the folder of its source too": "or write a model: "
    "`rtron model draft`",
}
_CORRECT = "correct the launch file, or add the file to its package and its build files"


def nodes_read(graph: InteractionGraph) -> str:
    """Return how many nodes were read, where some were not."""
    unread = [node for node in graph.nodes if node.unread]
    if not unread:
        return ""
    names = ", ".join(node.name for node in unread[:_MOST_EXAMPLES])
    more = f" and {len(unread) - _MOST_EXAMPLES} more" if len(unread) > _MOST_EXAMPLES else ""
    read = len(graph.nodes) - len(unread)
    return f"{read} of {len(graph.nodes)} nodes read; not read: {names}{more}"


def unresolved_list(unresolved: Sequence[UnresolvedItem], page: TextPage) -> Iterator[Text]:
    """Yield the causes, those that hide nodes first, then the most frequent."""
    causes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for item in unresolved:
        causes[item.why].append(item)
    ordered = sorted(causes, key=lambda why: (not _remedy(causes[why][0]), -len(causes[why])))
    if unresolved:
        yield from heading(f"Not resolved ({len(unresolved)})")
    for why in ordered[:MOST_CAUSES]:
        yield from _cause(why, causes[why], page)
    if len(ordered) > MOST_CAUSES:
        more = f"and {len(ordered) - MOST_CAUSES} more causes, which --format graph lists"
        yield line((more, "dim"), indent=2)


def _cause(why: str, items: Sequence[UnresolvedItem], page: TextPage) -> Iterator[Text]:
    first = items[0]
    at = f" ({location(first.evidence[0])})" if first.evidence else ""
    if len(items) == 1:
        yield from paragraph(f"{first.what}: {why}{at}", page, indent=2)
    else:
        names = list(dict.fromkeys(item.what for item in items))
        more = f" and {len(names) - _MOST_EXAMPLES} more" if len(names) > _MOST_EXAMPLES else ""
        shown = f"{'; '.join(names[:_MOST_EXAMPLES])}{more}"
        yield from paragraph(f"{len(items)} times: {why}: {shown}{at}", page, indent=2)
    if remedy := _remedy(first):
        yield from paragraph(f"-> {remedy}", page, indent=4, style="green")


def _remedy(item: UnresolvedItem) -> str:
    return _CORRECT if item.missing else _REMEDIES.get(item.why, "")
