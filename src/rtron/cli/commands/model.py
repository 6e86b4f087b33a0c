"""`rtron model`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Output
from rtron.cli.support.outcome import STDOUT, Outcome
from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtron.vocabulary import UnresolvedItem

model = typer.Typer(name="model", no_args_is_help=True, help="Write models of known nodes.")


@model.callback()
def model_group() -> None:
    """Models describe the interfaces of known nodes without source."""


@model.command()
def draft(
    source: Annotated[Path, typer.Argument(metavar="PATH", help="A node's script or main source.")],
    *,
    packages: Annotated[
        list[Path] | None,
        typer.Option(metavar="DIR", help="A folder with its packages; can be repeated."),
    ] = None,
    output: Output = STDOUT,
) -> Outcome:
    """Draft a model of a node from its source.

    The draft is YAML, described in docs/models.md. Check every entry, and fill
    in the repository and its tag. Unresolved names are listed on standard
    error.

    $ rtron model draft src/my_package/scripts/my_node.py
    $ rtron model draft my_package/src/main.cpp --packages src -o my_node.yaml

    Exit code: 0 drafted, 2 no program.
    """
    from rtron.sources.static.common.model_draft import draft_model
    from rtron.sources.static.common.worker import deep_recursion
    from rtron.sources.workspace import read_workspace

    workspace = read_workspace(packages or [_package(source)], {})
    with deep_recursion():
        drafted = draft_model(source, workspace)
    _print_unresolved(drafted.unresolved)
    return Outcome(drafted.text, to=output)


def _package(source: Path) -> Path:
    """Return the folder of the package that a file lies in, else the file's own."""
    parents = source.absolute().parents
    return next((folder for folder in parents if (folder / "package.xml").is_file()), parents[0])


def _print_unresolved(unresolved: "Sequence[UnresolvedItem]") -> None:
    from rich.console import Console
    from rich.text import Text

    console = Console(stderr=True, highlight=False)
    for each in unresolved:
        location = "".join(f"{e.file}:{e.line}: " for e in each.evidence[:1])
        console.print(Text(sanitize(f"{location}{each.what}: {each.why}")), soft_wrap=True)
