"""What pytest has written of a run's tests (`--junitxml`)."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET


@dataclass(frozen=True)
class TestCase:
    """A test of a run: its outcome, the first line of why, and its time in seconds."""

    place: str
    name: str
    outcome: str
    reason: str
    seconds: float


def read_report(report: Path) -> Iterator[TestCase]:
    """Yield the tests of a report; each is `passed`, `failed` or `skipped`."""
    for case in ET.parse(report).iter("testcase"):  # noqa: S314 - pytest wrote it
        place = case.get("classname", "").replace(".", "/")
        seconds = float(case.get("time", 0))
        yield TestCase(place, case.get("name", ""), *_outcome(case), seconds)


def _outcome(case: ET.Element) -> tuple[str, str]:
    for child in case:
        if child.tag in ("failure", "error", "skipped"):
            reason = (child.get("message") or child.text or "no reason").splitlines()[0]
            return ("skipped" if child.tag == "skipped" else "failed"), reason
    return "passed", ""
