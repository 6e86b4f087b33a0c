"""The report of `rtron verify`: whether guarded traffic passes through the guard."""

from collections.abc import Iterator, Mapping

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary.verification import GuardedPath, PathState, Verification

VERIFY_SCHEMA = "rtron.verify/1"
_STYLES = {
    PathState.CLOSED: "green",
    PathState.OPEN: "bold red",
    PathState.DRIFT: "bold red",
    PathState.UNKNOWN: "yellow",
    PathState.NOT_SEEN: "yellow",
    PathState.ABSENT: "dim",
}


def verification_text(title: str, verification: Verification) -> Report:
    """Return a report: the verdict, the paths with their problems, and unguarded interfaces."""
    return Report(lambda page: _lines(title, verification, page))


def verification_to_json(verification: Verification) -> Mapping[str, object]:
    """Return the JSON document: the verdict, paths, problems and unguarded interfaces."""
    return {
        "schema": VERIFY_SCHEMA,
        "verdict": _verdict(verification),
        "paths": [
            {
                "topic": path.topic,
                "private": path.private,
                "node": path.node,
                "state": str(path.state),
                "reason": path.reason,
                "foreign": list(path.foreign),
            }
            for path in verification.paths
        ],
        "not_seen": list(verification.not_seen),
        "problems": list(verification.problems),
        "unguarded": [{"what": each.what, "why": each.why} for each in verification.unguarded],
        "proven": list(verification.proven),
    }


def _verdict(verification: Verification) -> str:
    """Return the verdict: closed, open or unknown."""
    if verification.is_closed:
        return "closed"
    return "open" if verification.is_conclusive else "unknown"


def _lines(title: str, verification: Verification, page: TextPage) -> Iterator[Text]:
    verdict_text = _verdict(verification)
    yield line(
        (title, "bold"),
        "  ",
        (verdict_text, "bold green" if verification.is_closed else "bold red"),
    )
    for problem in verification.problems:
        yield from paragraph(problem, page, indent=2, style="red")
    if verification.not_seen:
        yield from paragraph(_unseen_text(verification), page, indent=2, style="yellow")
    yield from heading(counted(len(verification.paths), "planned path"))
    rows = [(str(path.state), path.node, path.private) for path in verification.paths]
    for path, row in zip(verification.paths, columns(rows, indent=2) if rows else [], strict=True):
        row.stylize(_STYLES[path.state], 2, 2 + len(str(path.state)))
        yield row
        yield from _why(path, page)
    if verification.proven:
        yield from heading("Tried")
        for proven in verification.proven:
            yield from paragraph(proven, page, indent=2, style="green")
    if verification.unguarded:
        yield from heading("Not guarded")
        for each in verification.unguarded:
            yield line((each.what, "cyan"), f"  {each.why}", indent=2)


def _unseen_text(verification: Verification) -> str:
    names = ", ".join(verification.not_seen)
    return f"not seen: {names}; start them, or say --absent NAME for those that are off"


def _why(path: GuardedPath, page: TextPage) -> Iterator[Text]:
    if path.reason:
        yield from paragraph(path.reason, page, indent=15)
