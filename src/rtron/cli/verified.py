"""What `rtron verify --live` found, as a table and as JSON."""

from collections.abc import Iterator, Mapping

from rich.text import Text

from rtron.guard.audit.verification import Path, PathState, Verification
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph

VERIFY_SCHEMA = "rtron.verify/1"
_STYLES = {
    PathState.CLOSED: "green",
    PathState.OPEN: "bold red",
    PathState.DRIFT: "bold red",
    PathState.UNKNOWN: "yellow",
    PathState.NOT_RUNNING: "dim",
}


def verified_text(title: str, found: Verification) -> Report:
    """Return the verdict, the paths, what is wrong with them, and what is not guarded."""
    return Report(lambda page: _lines(title, found, page))


def verified_json(found: Verification) -> Mapping[str, object]:
    """Return the document: the verdict, and all that was found."""
    return {
        "schema": VERIFY_SCHEMA,
        "verdict": verdict(found),
        "paths": [
            {
                "topic": path.topic,
                "private": path.private,
                "node": path.node,
                "state": str(path.state),
                "reason": path.reason,
                "foreign": list(path.foreign),
            }
            for path in found.paths
        ],
        "problems": list(found.problems),
        "unguarded": [{"what": each.what, "why": each.why} for each in found.unguarded],
    }


def verdict(found: Verification) -> str:
    """Return the verdict in a word or two."""
    if found.closed:
        return "closed"
    return "open" if found.told else "cannot tell"


def _lines(title: str, found: Verification, page: TextPage) -> Iterator[Text]:
    said = verdict(found)
    yield line((title, "bold"), "  ", (said, "bold green" if found.closed else "bold red"))
    for problem in found.problems:
        yield from paragraph(problem, page, indent=2, style="red")
    yield from heading(counted(len(found.paths), "planned path"))
    rows = [(str(path.state), path.node, path.private) for path in found.paths]
    for path, row in zip(found.paths, columns(rows, indent=2) if rows else [], strict=True):
        row.stylize(_STYLES[path.state], 2, 2 + len(str(path.state)))
        yield row
        yield from _why(path, page)
    if found.unguarded:
        yield from heading("Not guarded")
        for each in found.unguarded:
            yield line((each.what, "cyan"), f"  {each.why}", indent=2)


def _why(path: Path, page: TextPage) -> Iterator[Text]:
    if path.reason:
        yield from paragraph(path.reason, page, indent=15)
