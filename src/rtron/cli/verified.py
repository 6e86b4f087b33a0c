"""What `rtron verify --live` found, as a table and as JSON."""

from collections.abc import Iterator, Mapping

from rich.text import Text

from rtron.guard.audit.ros1.verification import GuardedPath, PathState, Verification
from rtron.reports.lines import Page, Report, columns, counted, heading, line, paragraph

VERIFY_SCHEMA = "rtron.verify/1"
_STYLES = {
    PathState.CLOSED: "green",
    PathState.OPEN: "bold red",
    PathState.DRIFT: "bold red",
    PathState.UNKNOWN: "yellow",
    PathState.NOT_RUNNING: "dim",
}


def verification_text(title: str, verification: Verification) -> Report:
    """Return the verdict, the paths, what is wrong with them, and what is not guarded."""
    return Report(lambda page: _lines(title, verification, page))


def verification_to_json(verification: Verification) -> Mapping[str, object]:
    """Return the document: the verdict, and all that was found."""
    return {
        "schema": VERIFY_SCHEMA,
        "verdict": verdict(verification),
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
        "problems": list(verification.problems),
        "unguarded": [{"what": each.what, "why": each.why} for each in verification.unguarded],
    }


def verdict(verification: Verification) -> str:
    """Return the verdict in a word or two."""
    if verification.is_closed:
        return "closed"
    return "open" if verification.is_conclusive else "cannot tell"


def _lines(title: str, verification: Verification, page: Page) -> Iterator[Text]:
    verdict_text = verdict(verification)
    yield line(
        (title, "bold"),
        "  ",
        (verdict_text, "bold green" if verification.is_closed else "bold red"),
    )
    for problem in verification.problems:
        yield from paragraph(problem, page, indent=2, style="red")
    yield from heading(counted(len(verification.paths), "planned path"))
    rows = [(str(path.state), path.node, path.private) for path in verification.paths]
    for path, row in zip(verification.paths, columns(rows, indent=2) if rows else [], strict=True):
        row.stylize(_STYLES[path.state], 2, 2 + len(str(path.state)))
        yield row
        yield from _why(path, page)
    if verification.unguarded:
        yield from heading("Not guarded")
        for each in verification.unguarded:
            yield line((each.what, "cyan"), f"  {each.why}", indent=2)


def _why(path: GuardedPath, page: Page) -> Iterator[Text]:
    if path.reason:
        yield from paragraph(path.reason, page, indent=15)
