"""Why a repository has its functions, as text for the person who doubts it."""

from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from itertools import groupby
from typing import TypeAlias

from rich.text import Text

from rtron.functions.classifier.result import Classification, DecisionSource, InformationSource
from rtron.functions.classifier.rule_trace import RuleMatch
from rtron.functions.repository import SourceRepository
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph

_PIECE_NAMES = {
    InformationSource.NAME: "name",
    InformationSource.MANIFEST: "description",
    InformationSource.CODE: "code",
    InformationSource.README: "README",
}
_PACKAGE = "package "
_NOTHING = "no rule tells what this is: no name, no description, no code, no README"
_WEAK = "no rule decides: what matches is too weak, or speaks for several functions alike"
_MAX_ROWS = 20
_MAX_WORDS = 4
Key: TypeAlias = tuple[str, InformationSource, str]


def evidence_text(
    repository: SourceRepository, classification: Classification, matched: Sequence[RuleMatch]
) -> Report:
    """Return a repository's class with every rule that matched, and what became of it."""
    return Report(lambda page: _lines(repository, classification, matched, page))


def _lines(
    repository: SourceRepository,
    classification: Classification,
    matched: Sequence[RuleMatch],
    page: TextPage,
) -> Iterator[Text]:
    yield from _header(repository, classification, page)
    is_decided = classification.decided_by is not DecisionSource.NONE
    deciding = classification.evidence if is_decided else ()
    decided = {(each.package, each.source, each.rule) for each in deciding}
    for origin, group in groupby(matched, _origin):
        yield from heading(origin or f"repository {repository.name}")
        package = origin.removeprefix(_PACKAGE)
        functions = classification.packages.get(package, ()) if package else ()
        if functions:
            yield line((", ".join(map(str, functions)), "green"), indent=2)
        yield from _rows(list(group), decided)


def _origin(each: RuleMatch) -> str:
    if each.source is InformationSource.README:
        return "README"
    return f"{_PACKAGE}{each.package}" if each.package else ""


def _header(
    repository: SourceRepository, classification: Classification, page: TextPage
) -> Iterator[Text]:
    read = [counted(len(repository.packages), "package")]
    read += ["a README"] if repository.readme else []
    yield line((repository.name, "bold"), f"  {', '.join(read)}")
    if classification.decided_by is DecisionSource.NONE:
        yield from paragraph(_WEAK if classification.evidence else _NOTHING, page, style="yellow")
        how = "as most such repositories are"
    else:
        how = f"decided by the {_PIECE_NAMES[InformationSource(classification.decided_by)]}"
    primary = (str(classification.primary), "bold green")
    yield line(primary, f", {how}, {_percent(classification.confidence)} sure")
    others = {f: p for f, p in classification.probabilities.items() if f != classification.primary}
    for word, is_given in (("and", True), ("perhaps", False)):
        named = [
            f"{function} ({_percent(probability)})"
            for function, probability in others.items()
            if (function in classification.functions) is is_given
        ]
        if named:
            yield from paragraph(f"{word} {', '.join(named)}", page)


def _percent(probability: float | None) -> str:
    return "" if probability is None else f"{100 * probability:.0f} %"


def _rows(matched: Sequence[RuleMatch], decided: AbstractSet[Key]) -> Iterator[Text]:
    texts: dict[tuple[Key, RuleMatch], list[str]] = {}
    for each in matched:
        key = (each.package, each.source, each.rule)
        texts.setdefault((key, replace(each, text="")), []).append(each.text)
    rows = [_row(each, words, key in decided) for (key, each), words in texts.items()]
    yield from columns(rows[:_MAX_ROWS], ("", "", "dim", "yellow", "cyan"), indent=2)
    if len(rows) > _MAX_ROWS:
        yield line((f"and {len(rows) - _MAX_ROWS} more rules", "dim"), indent=2)


def _row(each: RuleMatch, words: Sequence[str], decided: bool) -> Sequence[str]:  # noqa: FBT001 - a cell
    fate = "vetoed" if each.is_vetoed else "decided" if decided else ""
    quoted = ", ".join(f"“{word}”" for word in words[:_MAX_WORDS])
    more = ", …" if len(words) > _MAX_WORDS else ""
    return (
        str(each.type),
        f"{each.weight:g}",
        each.rule,
        fate,
        f"{_PIECE_NAMES[each.source]} {quoted}{more}",
    )
