"""`rtron explain-function`."""

import re
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Readmes
from rtron.cli.support.outcome import Outcome
from rtron.cli.support.skipped_report import print_to_stderr, report_skipped
from rtron.errors import InputError, RTronError
from rtron.folders import is_folder
from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from rtron.functions.repository import SourceRepository

_LONGEST_SHOWN = 80
_SEVERAL_SHOWN = 5
_COMPLETABLE_NAME = re.compile(r"[\w@.+-]+")
"""Names that a shell takes as they are: what is completed stands on its line unquoted."""


def _complete(ctx: typer.Context, incomplete: str) -> list[str]:
    from rtron.functions.reading import read_repositories

    try:
        source = ctx.params.get("source")
        found = read_repositories(Path(source), None, lambda _: None) if source else []
    except (RTronError, OSError):
        return []
    names = (each.name for each in found if _COMPLETABLE_NAME.fullmatch(each.name))
    return [name for name in names if name.startswith(incomplete)]


def explain_function(
    repo: Annotated[
        str,
        typer.Argument(
            metavar="DIR|NAME", help="The repository, or a package of it.", autocompletion=_complete
        ),
    ],
    *,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE.jsonl|DIR|distribution.yaml",
            help="The file or folder that describes the repository NAME.",
        ),
    ] = None,
    readmes: Readmes = None,
) -> Outcome:
    """Explain why a repository has its functions.

    It shows how sure each function is, and every rule that matches: where, on
    which words or code, with its weight, and whether a veto or an earlier text
    decided otherwise.

    $ rtron explain-function src/navigation
    $ rtron explain-function --from kinetic.jsonl rrt_exploration
    $ rtron explain-function --from kinetic.jsonl --readmes readmes.jsonl amcl

    The shell completes a NAME after --from. The name of a package means its
    repository.

    Exit code: 0 explained, 2 no such repository.
    """
    from rtron.functions.classifier.pipeline import classify
    from rtron.functions.classifier.rule_trace import trace_rules
    from rtron.functions.reading.package_code import read_code
    from rtron.reports.functions.classification import evidence_text

    found = read_code(_find_repository(repo, source, readmes))
    return Outcome(evidence_text(found, classify(found), trace_rules(found)))


def _find_repository(repo: str, source: Path | None, readmes: Path | None) -> "SourceRepository":
    from rtron.functions.reading import read_repositories

    if source is None and not is_folder(Path(repo)):
        help = "give its folder, or say --from which file"
        raise InputError(f"{repo[:_LONGEST_SHOWN]!r} is no folder", help=help)
    with report_skipped() as note_skipped:
        found = read_repositories(source or Path(repo), readmes, note_skipped)
    return _repository_named(repo, found) if source else _single_repository(repo, found)


def _single_repository(repo: str, found: "list[SourceRepository]") -> "SourceRepository":
    if len(found) > 1:
        names = [each.name for each in found[:_SEVERAL_SHOWN]]
        more = ["…"] if len(found) > _SEVERAL_SHOWN else []
        names_text = ", ".join(names + more)
        help = f"rtron explain-function --from {repo} NAME"
        raise InputError(f"{repo} holds {len(found)} repositories: {names_text}", help=help)
    return found[0]


def _repository_named(repo: str, found: "list[SourceRepository]") -> "SourceRepository":
    """Return the repository of a name, else the first that has a package of that name."""
    names = {each.name: each for each in found}
    if repo in names:
        return names[repo]
    repository_by_package = {
        package.name: each for each in reversed(found) for package in each.packages
    }
    if repo in repository_by_package:
        print_to_stderr(sanitize(f"{repo} is a package of {repository_by_package[repo].name}"))
        return repository_by_package[repo]
    near = get_close_matches(repo[:_LONGEST_SHOWN], names, n=1)
    help = f"did you mean {near[0]}?" if near else "`rtron classify` lists them all"
    raise InputError(f"no repository is named {repo[:_LONGEST_SHOWN]!r}", help=help)
