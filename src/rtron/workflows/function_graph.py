"""The graph of functions: which packages of an ecosystem exchange which messages."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.functions.app_categories import AppProfile, app_profile
from rtron.functions.classifier.pipeline import classify
from rtron.functions.classifier.result import Classification
from rtron.functions.interactions.abstract_graph import (
    AbstractGraph,
    PackageMessages,
    abstract_graph,
)
from rtron.functions.reading import SkippedEntry, SkippedHandler, read_repositories
from rtron.functions.reading.package_code import read_code
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.sources.bounded_file import STDIN
from rtron.sources.graph_json import read_graph
from rtron.sources.static.common.scan_options import Progress, ScanOptions
from rtron.sources.static.ros1.message_traffic import PackageTraffic, WorkspaceTraffic, read_traffic
from rtron.sources.workspace.package_files import is_regular
from rtron.vocabulary import FunctionType

_NO_TRAFFIC = PackageTraffic()


def build_function_graph(
    source: Path, readmes: Path | None, options: ScanOptions, note_skipped: SkippedHandler
) -> AbstractGraph:
    """Return the graph of a corpus, a folder or a distribution; of a folder with its messages.

    READMEs may stand in a file beside it. Of packages with one name the first counts; others, and
    all that cannot be read, go to `note_skipped`. Raise InputError if nothing can be read.
    """
    repositories = read_repositories(source, readmes, note_skipped)
    classified = list(classify_repositories(repositories, note_skipped, options.progress))
    first_packages = _first_of_each_name(repositories)
    traffic = WorkspaceTraffic(packages={})
    if source != STDIN and source.is_dir():
        traffic = _traffic(source, first_packages, options)
    for note in traffic.unresolved:
        location = note.evidence[0].file if note.evidence else str(source)
        note_skipped(SkippedEntry(location=location, reason=f"{note.what}: {note.why}"))
    repeated = sum(_report_duplicates(each, first_packages, note_skipped) for each in repositories)
    graph = abstract_graph(_package_uses(classified, first_packages, traffic))
    return replace(graph, repeated=repeated, unresolved=traffic.unresolved)


def _first_of_each_name(repositories: Sequence[SourceRepository]) -> dict[str, SourcePackage]:
    found: dict[str, SourcePackage] = {}
    for repository in repositories:
        for package in repository.packages:
            found.setdefault(package.name, package)
    return found


def _report_duplicates(
    repository: SourceRepository,
    first_packages: Mapping[str, SourcePackage],
    note_skipped: SkippedHandler,
) -> int:
    """Return how many of a repository's packages do not count, since others have their names."""
    names = [each.name for each in repository.packages if first_packages[each.name] is not each]
    if names:
        why = f"the first package of a name counts; there before: {', '.join(names)}"
        note_skipped(SkippedEntry(location=repository.name, reason=why))
    return len(names)


def _traffic(
    top: Path, first_packages: Mapping[str, SourcePackage], options: ScanOptions
) -> WorkspaceTraffic:
    folders = {name: each.folder.absolute() for name, each in first_packages.items() if each.folder}
    return read_traffic(top, folders, options)


def _package_uses(
    classified: Iterable[tuple[SourceRepository, Classification]],
    first_packages: Mapping[str, SourcePackage],
    traffic: WorkspaceTraffic,
) -> Iterator[PackageMessages]:
    for repository, found in classified:
        for package in repository.packages:
            if first_packages[package.name] is package:
                yield _package_use(package, found, traffic)


def _package_use(
    package: SourcePackage, found: Classification, traffic: WorkspaceTraffic
) -> PackageMessages:
    used = _NO_TRAFFIC
    if package.folder:
        used = traffic.packages.get(package.folder.absolute(), _NO_TRAFFIC)
    return PackageMessages(
        name=package.name,
        description=package.description,
        functions=_functions(package, found),
        publishes=frozenset(used.publishes),
        subscribes=frozenset(used.subscribes),
        depends=frozenset(package.depends),
    )


def _functions(package: SourcePackage, found: Classification) -> tuple[FunctionType, ...]:
    """Return a package's own functions, else its repository's first one."""
    return found.packages.get(package.name, ()) or found.functions[:1]


def read_app_rows(paths: Sequence[Path], note_skipped: SkippedHandler) -> list[AppProfile]:
    """Return the apps of files, or of those in folders; several are named by their files.

    What cannot be read goes to `note_skipped`. Raise InputError if nothing can.
    """
    files = [file for path in paths for file in _graph_files(path, note_skipped)]
    results = [(file, _read_row(file, file.stem if len(files) > 1 else "")) for file in files]
    rows = [row for _, row in results if isinstance(row, AppProfile)]
    for file, error in results:
        if isinstance(error, InputError):
            if not rows:
                raise error
            location = f"{file}:{error.line}" if error.line else str(file)
            note_skipped(SkippedEntry(location=location, reason=error.reason))
    return rows


def _read_row(file: Path, name: str) -> AppProfile | InputError:
    try:
        return app_profile(read_graph(file), name)
    except InputError as error:
        return error


def _graph_files(path: Path, note_skipped: SkippedHandler) -> list[Path]:
    """Return a file, or those in a folder by name: a pipe in it would be waited for."""
    if not is_folder(path):
        return [path]
    candidates = sorted(path.glob("*.json"))
    for other in (each for each in candidates if not is_regular(each)):
        note_skipped(SkippedEntry(location=str(other), reason="is no file"))
    found = [each for each in candidates if is_regular(each)]
    if not found:
        help = "write them with `rtron scan … --format graph -o app.json`"
        raise InputError("has no *.json", path=str(path), help=help)
    return found


def classify_repositories(
    repositories: Sequence[SourceRepository], note_skipped: SkippedHandler, progress: Progress
) -> Iterator[tuple[SourceRepository, Classification]]:
    """Yield repositories with their classes; the code of those that are folders is read.

    A repository that fails costs itself only, and goes to `note_skipped`.
    """
    for done, repository in enumerate(repositories, 1):
        progress(done, len(repositories), repository.name)
        try:
            found = classify(read_code(repository))
        except Exception as error:  # noqa: BLE001 - one of thousands must not end the others
            reason = f"{type(error).__name__}: {error}"
            note_skipped(SkippedEntry(location=repository.name, reason=reason))
        else:
            yield repository, found
