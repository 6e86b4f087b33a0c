"""The packages that `rtron functions graph` looks at: their functions and their messages."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.cli.support.progress import shown_progress
from rtron.cli.support.skipped_report import left_out
from rtron.functions.classifier.result import Classification
from rtron.functions.interactions.abstract_graph import AbstractGraph, PackageUse, abstract_graph
from rtron.functions.reading import Note, Skipped, read_repositories
from rtron.functions.repository import Package, Repository
from rtron.sources.bounded_file import STDIN
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.message_traffic import PackageTraffic, Traffic, read_traffic
from rtron.vocabulary import FunctionType
from rtron.workflows.classification import classified

_NO_TRAFFIC = PackageTraffic()


@dataclass(frozen=True, slots=True)
class Asked:
    """A corpus, a folder or a distribution, READMEs beside it, and where to work on it."""

    given: Path
    readmes: Path | None = None
    jobs: int | None = None
    cluster: str | None = None


def interaction_graph(asked: Asked, options: ScanOptions) -> AbstractGraph:
    """Return the graph of what is asked for; of a folder with its messages.

    Of packages with one name the first counts. Raise InputError if nothing can be read; what is
    left out is told on standard error.
    """
    given = asked.given
    with left_out() as left:
        repositories = read_repositories(given, asked.readmes, left)
        known = list(classified(repositories, asked.jobs, asked.cluster, left))
        counting = _first_of_each_name(repositories)
        traffic = Traffic(packages={})
        if given != STDIN and given.is_dir():
            traffic = _traffic(given, counting, options)
        for note in traffic.unresolved:
            place = note.evidence[0].file if note.evidence else str(given)
            left(Skipped(place=place, why=f"{note.what}: {note.why}"))
        repeated = sum(_tell_repeated(each, counting, left) for each in repositories)
    graph = abstract_graph(_uses(known, counting, traffic))
    return replace(graph, repeated=repeated, unresolved=traffic.unresolved)


def _first_of_each_name(repositories: Sequence[Repository]) -> dict[str, Package]:
    found: dict[str, Package] = {}
    for repository in repositories:
        for package in repository.packages:
            found.setdefault(package.name, package)
    return found


def _tell_repeated(repository: Repository, counting: Mapping[str, Package], left: Note) -> int:
    """Return how many of a repository's packages do not count, since others have their names."""
    names = [each.name for each in repository.packages if counting[each.name] is not each]
    if names:
        why = f"the first package of a name counts; there before: {', '.join(names)}"
        left(Skipped(place=repository.name, why=why))
    return len(names)


def _traffic(top: Path, counting: Mapping[str, Package], options: ScanOptions) -> Traffic:
    folders = {name: each.folder.absolute() for name, each in counting.items() if each.folder}
    with shown_progress() as progress:
        return read_traffic(top, folders, replace(options, progress=progress))


def _uses(
    known: Iterable[tuple[Repository, Classification]],
    counting: Mapping[str, Package],
    traffic: Traffic,
) -> Iterator[PackageUse]:
    for repository, found in known:
        for package in repository.packages:
            if counting[package.name] is package:
                yield _use(package, found, traffic)


def _use(package: Package, found: Classification, traffic: Traffic) -> PackageUse:
    used = _NO_TRAFFIC
    if package.folder:
        used = traffic.packages.get(package.folder.absolute(), _NO_TRAFFIC)
    return PackageUse(
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
