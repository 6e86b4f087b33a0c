"""The functions of an app's nodes, as text: by domain, in the order of the paper's table."""

from collections.abc import Iterable, Iterator

from rich.text import Text

from rtron.reports.text_layout import TextPage, counted, heading, paragraph
from rtron.vocabulary import FunctionType, Node

MOST_NAMES = 8


def node_functions(nodes: Iterable[Node], page: TextPage) -> Iterator[Text]:
    """Yield a paragraph for each function with its nodes; nothing where no function is known."""
    all_nodes = tuple(nodes)
    known = [node for node in all_nodes if node.function]
    if not known:
        return
    yield from heading("Functions of the nodes")
    for function in FunctionType:
        members = [node for node in known if node.function is function]
        if members:
            text = f"{members[0].domain or function}, {function}: {_names(members)}"
            yield from paragraph(text, page, indent=2)
    unknown = [node for node in all_nodes if not node.function]
    if unknown:
        yield from paragraph(f"not known: {_names(unknown)}", page, indent=2, style="dim")


def _names(nodes: list[Node]) -> str:
    names = [node.name for node in nodes[:MOST_NAMES]]
    left = len(nodes) - MOST_NAMES
    return ", ".join([*names, f"and {counted(left, 'other')}"] if left > 0 else names)
