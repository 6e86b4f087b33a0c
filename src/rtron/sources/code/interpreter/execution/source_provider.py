"""What a program needs of its workspace, which finds it when it is needed."""

from pathlib import Path
from typing import NamedTuple, Protocol

from rtron.sources.code import ir


class PluginSource(NamedTuple):
    """A class that pluginlib would load, and the sources of its library."""

    class_name: str
    sources: tuple[Path, ...]


class SourceProvider(Protocol):
    """The source around a program."""

    def lowered_unit(self, path: Path, language: ir.SourceLanguage) -> ir.Unit:
        """Return a file, lowered."""

    def header(self, include: str, includer: Path) -> Path | None:
        """Return the file that `#include` means, where the workspace has it."""

    def python_module(self, dotted: str, importer: Path) -> Path | None:
        """Return the file of a Python module or package, where the workspace has it."""

    def has_message_type(self, package: str, name: str) -> bool | None:
        """Tell whether a package defines a message type; None if the package is not known."""

    def package_path(self, package: str) -> Path | None:
        """Return where a package lies."""

    def package_names(self) -> tuple[str, ...]:
        """Return the names of the packages of the workspace."""

    def is_dependency(self, package: str, path: Path) -> bool:
        """Tell whether the package of a file says that it depends on another."""

    def read_text(self, path: Path) -> str | None:
        """Return a data file of the workspace; None for one that is not there or too large."""

    def find_plugin(self, name: str, base: str) -> PluginSource | None:
        """Return the class that pluginlib knows by a name or type."""

    def is_plugin(self, name: str) -> bool:
        """Tell whether a class of this name or type is registered, for whatever base."""

    def plugin_names(self, base: str) -> tuple[str, ...]:
        """Return the names of all plugins of a base class."""

    def library_sources(self, name: str) -> tuple[Path, ...]:
        """Return the sources of the library that a file name means."""

    def libraries_containing(self, word: str) -> tuple[tuple[Path, ...], ...]:
        """Return the sources of each library that has a word in one of them."""

    def sources_containing(self, sources: tuple[Path, ...], word: str) -> tuple[Path, ...]:
        """Return those of some sources whose text has a word."""

    def sources_defining(self, header: Path, word: str) -> tuple[Path, ...]:
        """Return the sources of a header's package that may define a class or function.

        `word` is the plain name of the class or function.
        """
