"""The paper's two tables beside the same of other repositories, as text."""

from collections.abc import Iterator, Sequence

from rich.text import Text

from rtron.functions.classifier.tables import (
    AUTOMATION_BY_TYPE,
    CLASSIFICATION_COUNTS,
    FUNCTION_NODE_AUTOMATION,
    FUNCTION_NODE_COUNTS,
    REPOSITORIES_BY_TYPE,
    ClassificationCounts,
    PaperTables,
    sum_domains,
    sum_function_nodes,
)
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.reports.text_layout import Report, TextPage, heading, line, paragraph
from rtron.vocabulary import Domain, FunctionType

_WIDTH = 20
_PIECE_WIDTHS = {"name": 7, "manifest": 9, "code": 7, "readme": 8, "none": 7}
_NOTE = (
    "A repository counts once for each of its functions. One that no rule decides counts as an "
    "Extension that a person looks at (`none`): which function it has, nothing tells. So the "
    "rates of the other types are 100 % where the paper, which looked, has less."
)


def tables_text(tables: PaperTables) -> Report:
    """Return both tables, the paper's numbers beside each."""
    return Report(lambda page: _lines(tables, page))


def _lines(tables: PaperTables, page: TextPage) -> Iterator[Text]:
    share = _percent(tables.decided, tables.repositories)
    yield line(
        (f"{tables.repositories} repositories", "bold"), f", {tables.decided} decided ({share} %)"
    )
    if tables.expected_right is not None:
        expected = 100 * tables.expected_right
        yield line(f"{expected:.1f} % of the first functions are expected to be right")
    yield from heading("Repositories by domain and function type")
    yield from _by_type(tables)
    yield from heading("What decided, and how many without a person")
    yield from _by_piece(tables)
    yield Text()
    yield from paragraph(_NOTE, page, style="dim")


def _by_type(tables: PaperTables) -> Iterator[Text]:
    total = sum_domains(tables.types, Domain).total
    of_paper = sum(REPOSITORIES_BY_TYPE.values())
    yield line(f"{'':{_WIDTH}}{'repos':>8}{'%':>7}{'paper':>10}{'%':>7}", indent=2)
    for domain in Domain:
        ours = sum_domains(tables.types, (domain,)).total
        theirs = sum(
            number
            for type, number in REPOSITORIES_BY_TYPE.items()
            if DOMAIN_BY_TYPE[type] is domain
        )
        yield _counts(domain, (ours, total), (theirs, of_paper), "bold")
        for type in _types(domain):
            numbers = (
                (tables.types[type].total, total),
                (REPOSITORIES_BY_TYPE[type], of_paper),
            )
            yield _counts(f"  {type}", *numbers)
    yield _counts("all", (total, total), (of_paper, of_paper), "bold")


def _counts(name: str, ours: tuple[int, int], theirs: tuple[int, int], style: str = "") -> Text:
    numbers = f"{ours[0]:>8}{_percent(*ours):>7}"
    of_paper = f"{theirs[0]:>10}{_percent(*theirs):>7}"
    return line((f"{name:{_WIDTH}}{numbers}", style), (of_paper, "dim"), indent=2)


def _by_piece(tables: PaperTables) -> Iterator[Text]:
    titles = "".join(f"{title:>{width}}" for title, width in _PIECE_WIDTHS.items())
    yield line(f"{'':{_WIDTH}}{titles}{'auto %':>8}{'paper':>8}", indent=2)
    for type in FunctionType:
        yield _pieces(type, tables.types[type], AUTOMATION_BY_TYPE[type])
        yield _pieces("", CLASSIFICATION_COUNTS[type], None, "dim")
    yield _pieces(
        "function nodes",
        sum_function_nodes(tables.types),
        FUNCTION_NODE_AUTOMATION,
        "bold",
    )
    yield _pieces("", FUNCTION_NODE_COUNTS, None, "dim")
    yield _pieces("all", sum_domains(tables.types, Domain), None, "bold")


def _pieces(name: str, tally: ClassificationCounts, rate: float | None, style: str = "") -> Text:
    cells = "".join(f"{getattr(tally, piece):>{width}}" for piece, width in _PIECE_WIDTHS.items())
    automation = "-" if tally.automation is None else f"{100 * tally.automation:.2f}"
    of_paper = "" if rate is None else f"{rate:.2f}"
    shown = f"{name:{_WIDTH}}{cells}{automation:>8}"
    return line((shown, style), (f"{of_paper:>8}", "dim"), indent=2)


def _types(domain: Domain) -> Sequence[FunctionType]:
    return [type for type in FunctionType if DOMAIN_BY_TYPE[type] is domain]


def _percent(number: int, total: int) -> str:
    return f"{100 * number / total:.1f}" if total else "-"
