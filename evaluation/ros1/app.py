"""An app to be scanned: its repositories, launch files and environment, as data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from evaluation.common.datasets import Datasets
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import StaticApp, scan_app


@dataclass(frozen=True, slots=True, kw_only=True)
class App:
    """The repositories of an app (`owner/name@commit`), and how it is started.

    `dependencies` are repositories of others that it uses. `launches` are `name/path`, the name
    being a repository's without owner and commit; the text `{name}` in a value of `environ`
    stands for that repository's folder.
    """

    name: str
    repositories: tuple[str, ...]
    launches: tuple[tuple[str, Mapping[str, str]], ...]
    dependencies: tuple[str, ...] = ()
    environ: Mapping[str, str] = field(default_factory=dict)

    def scan(self, datasets: Datasets, *, dependencies: bool, options: ScanOptions) -> StaticApp:
        """Return what the scan finds, with the dependencies' source or without it."""
        own = datasets.repositories(self.repositories)
        by_name = {folder.name.partition("@")[0]: folder for folder in own}
        others = datasets.present(self.dependencies) if dependencies else []
        environ = {key: value.format_map(by_name) for key, value in self.environ.items()}
        return scan_app([*own, *others], _launches(self, by_name), environ, options)


def _launches(app: App, by_name: Mapping[str, Path]) -> Sequence[tuple[Path, Mapping[str, str]]]:
    spelled = ((path.partition("/"), args) for path, args in app.launches)
    return [(by_name[name] / path, args) for (name, _, path), args in spelled]
