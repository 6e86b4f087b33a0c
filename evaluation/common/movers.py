"""What can move robots: what two readers list from source, and which of it an inventory names.

`evaluation/data/movers.yaml` lists apps (below RTRON_APPS, as `owner/name@commit`) with the
arguments of their scans, and the names that both readers listed before any scan.
"""

import re
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from evaluation.common.datasets import Datasets, MissingDatasetError, Reporter
from evaluation.common.findings import scan_report
from figures.figure import Figure

Inventory = Sequence[Mapping[str, Any]]
"""The inventory of a scan as its JSON has it."""

_DATA = Path(__file__).parents[1] / "data" / "movers.yaml"
_PLACEHOLDER = re.compile(r"\\\{\w+\\\}")


def figures(datasets: Datasets, reporter: Reporter) -> Iterator[Figure]:
    """Scan each app, and count the names that its inventory has; what is no app has none."""
    found: dict[int, list[float]] = defaultdict(lambda: [0, 0])
    for entry in yaml.safe_load(_DATA.read_text(encoding="utf-8"))["apps"]:
        reporter.progress(f"what moves {entry['repository']}")
        [folder] = datasets.repositories([entry["repository"]])
        missing = missing_names(_inventory(folder, entry["arguments"]), entry["names"])
        found[entry["set"]][0] += len(entry["names"]) - len(missing)
        found[entry["set"]][1] += len(entry["names"])
        reporter.detail([f"{entry['repository']}: missing {', '.join(missing) or 'nothing'}"])
    for number, (named, listed) in sorted(found.items()):
        yield Figure(f"movers.set{number}.listed", listed, None, "names")
        yield Figure(f"movers.set{number}.named", 100 * named / listed, None, "%", at_least=95)


def _inventory(folder: Path, arguments: Sequence[str]) -> Inventory:
    try:
        found: Inventory = scan_report(folder, arguments)["inventory"]
    except MissingDatasetError:
        return ()
    return found


def missing_names(inventory: Inventory, listed: Collection[str]) -> list[str]:
    """Return the listed names that no line of an inventory has; a parameter stands for its node."""
    commands = [command for mover in inventory for command in mover["commands"]]
    commands = [each for each in commands if not each["name"].endswith("}")]
    patterns = [re.compile(_pattern(each["name"], each["means"])) for each in commands]
    return [name for name in listed if not any(each.fullmatch(name) for each in patterns)]


def _pattern(name: str, means: str) -> str:
    """Return what matches the names that a command stands for."""
    if means == "parameter":
        node = name.removesuffix("/set_parameters").partition(".")[0]
        return f"{re.escape(node)}/(?:.+/)?set_parameters"
    return _PLACEHOLDER.sub("[^/]*", re.escape(name))
