"""What a scan tells people: the verdicts of readers, and the real bugs that it names.

`evaluation/data/judged_findings.yaml` lists apps (repositories below RTRON_APPS/APP/src) with the
arguments of their scans, and for each reader the verdict on each finding of the default level.

`evaluation/data/bugs.yaml` lists bugs, each with checkouts RTRON_APPS/bugs/ID/buggy and fixed, the
repository below src, and the names that a finding must be about.
"""

import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import yaml

from evaluation.common.datasets import Datasets, MissingDatasetError, Reporter
from figures.figure import Figure

Findings = Sequence[Mapping[str, Any]]
"""The findings of a scan as its JSON has them."""

ROSDISCOVER_NAMED = 8
"""Of the 19 bugs, those that ROSDiscover's paper names (Timperley et al., ICSA 2022)."""
_DATA = Path(__file__).parents[1] / "data"
_TIMEOUT_S = 600


def judged(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Scan the judged apps, and count the verdicts on what is shown at the default level."""
    data = yaml.safe_load((_DATA / "judged_findings.yaml").read_text(encoding="utf-8"))
    shown: dict[str, list[str]] = {}
    for entry in data["apps"]:
        reporter.progress(f"findings of {entry['app']}")
        [folder] = datasets.repositories([entry["app"]])
        found = scan(folder, entry["arguments"])
        shown[entry["app"]] = [each["id"] for each in found if each["level"] == "regular"]
    numbers = [len(ids) for ids in shown.values()]
    yield Figure("findings.apps", len(numbers), None, "apps", at_least=10)
    yield Figure("findings.median", median(numbers), None, "findings", at_most=12)
    yield Figure("findings.most", max(numbers), None, "findings")
    for reader, verdicts in data["readers"].items():
        counts = verdict_counts(shown, verdicts)
        reporter.detail([f"{reader}: {dict(counts)}"])
        yield from _verdict_figures(reader, counts)


def verdict_counts(
    shown: Mapping[str, Collection[str]], verdicts: Mapping[str, Mapping[str, str]]
) -> Counter[str]:
    """Return how often a reader gave each verdict; what he has not seen is `unjudged`."""
    return Counter(
        verdicts.get(app, {}).get(id, "unjudged") for app, ids in shown.items() for id in ids
    )


def _verdict_figures(reader: str, counts: Counter[str]) -> Iterator[Figure]:
    all_findings = max(counts.total() - counts["unjudged"], 1)
    good = 100 * (counts["useful"] + counts["arguable"]) / all_findings
    false = 100 * counts["false"] / all_findings
    yield Figure(f"findings.good.{reader}", good, None, "%", at_least=80)
    yield Figure(f"findings.false.{reader}", false, None, "%", at_most=3)
    yield Figure(f"findings.unjudged.{reader}", counts["unjudged"], None, "findings", at_most=0)


def bugs(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Scan the buggy and the fixed checkout of each bug, and look whether a finding names it."""
    entries = yaml.safe_load((_DATA / "bugs.yaml").read_text(encoding="utf-8"))
    named = []
    for entry in entries:
        reporter.progress(f"bug {entry['id']}")
        folders = datasets.repositories(f"bugs/{entry['id']}/{each}" for each in ("buggy", "fixed"))
        found = [scan(folder, entry["arguments"]) for folder in folders]
        if names := naming(*found, names=entry["names"]):
            named.append(entry["id"])
        reporter.detail([f"{entry['id']}: {', '.join(names) or 'not named'}"])
    yield Figure("bugs", len(entries), None, "bugs")
    yield Figure("bugs.named", len(named), ROSDISCOVER_NAMED, "bugs", at_least=16)


def naming(buggy: Findings, fixed: Findings, *, names: Collection[str]) -> list[str]:
    """Return the findings about one of `names` that the bug has and the fix has not."""
    gone = {each["id"] for each in buggy} - {each["id"] for each in fixed}
    return [each["id"] for each in buggy if each["id"] in gone and each["subject"] in names]


def scan(folder: Path, arguments: Sequence[str]) -> Findings:
    """Return the findings of a scan at every level; raise MissingDatasetError if it fails."""
    found: Findings = scan_report(folder, arguments)["findings"]
    return found


def scan_report(folder: Path, arguments: Sequence[str]) -> Mapping[str, Any]:
    """Return the JSON of a scan; raise MissingDatasetError if it fails."""
    command = [sys.executable, "-m", "rtron", "scan", *arguments, "--format", "json"]
    environ = {**os.environ, "ROS_PACKAGE_PATH": str(folder / "src")}
    done = subprocess.run(  # noqa: S603 - our own command
        command, cwd=folder, env=environ, capture_output=True, timeout=_TIMEOUT_S, check=False
    )
    if done.returncode not in (0, 1):
        raise MissingDatasetError(f"{folder.name}: {done.stderr.decode(errors='replace')[-300:]}")
    report: Mapping[str, Any] = json.loads(done.stdout)
    return report
