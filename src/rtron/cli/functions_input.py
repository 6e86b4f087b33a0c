"""The packages that `rtron functions graph` looks at: their functions and their messages."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.text import Text

from rtron.cli.progress import shown_progress
from rtron.functions.classification import Classification
from rtron.functions.classify import classify
from rtron.functions.graph import PackageUse
from rtron.functions.reading import Skipped, read_repositories
from rtron.functions.repository import Package, Repository
from rtron.reports.neutral import neutral
from rtron.sources.bounded import STDIN
from rtron.sources.static.options import ScanOptions
from rtron.sources.static.traffic import PackageTraffic, read_traffic
from rtron.vocabulary import FunctionType

_NO_TRAFFIC = PackageTraffic()


def package_uses(given: Path, options: ScanOptions) -> list[PackageUse]:
    """Return the packages of a corpus, a folder or a distribution; of a folder with its messages.

    Raise InputError if nothing can be read; what is left out is told on standard error.
    """
    repositories = read_repositories(given, None, _tell)
    traffic = _traffic(given, options) if given != STDIN and given.is_dir() else {}
    return list(_uses(repositories, traffic))


def _traffic(folder: Path, options: ScanOptions) -> Mapping[str, PackageTraffic]:
    with shown_progress() as progress:
        return read_traffic(folder, replace(options, progress=progress))


def _uses(
    repositories: Iterable[Repository], traffic: Mapping[str, PackageTraffic]
) -> Iterator[PackageUse]:
    for repository in repositories:
        found = classify(repository)
        for package in repository.packages:
            used = traffic.get(package.name, _NO_TRAFFIC)
            yield PackageUse(
                name=package.name,
                description=package.description,
                functions=_functions(package, found),
                publishes=frozenset(used.publishes),
                subscribes=frozenset(used.subscribes),
                depends=frozenset(package.depends),
            )


def _functions(package: Package, found: Classification) -> tuple[FunctionType, ...]:
    """Return a package's own functions, else its repository's first one."""
    return found.packages.get(package.name, ()) or found.functions[:1]


def _tell(skipped: Skipped) -> None:
    console = Console(stderr=True, highlight=False)
    console.print(Text(neutral(f"left out: {skipped}")), soft_wrap=True)
