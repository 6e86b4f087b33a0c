"""What a scan was not given and would need: packages, launch files, variables, arguments."""

import re
from collections.abc import Iterator, Sequence
from shlex import quote

from rtron.vocabulary import InteractionGraph, UnresolvedItem

_VARIABLE, _ARGUMENT = "environment variable ", "launch argument "
_PACKAGE = re.compile(r"package '([^']+)' is not (?:here|found)")
_OF_NODE = re.compile(r"\((\w+)/[^)]*\)$")
_NO_SOURCE = ("its package is not here", "no source of it is here")
_MOST_NAMES = 6


def missing_inputs(graph: InteractionGraph) -> Iterator[str]:
    """Yield a line for each kind of input that is missing, with how to give it."""
    unresolved = graph.unresolved
    if packages := _packages(unresolved):
        yield (
            f"not here: {_names('package', packages)}; "
            "give the folders of their source too: rtron scan PATH PATH…"
        )
    if files := [each.missing for each in unresolved if _is_include(each)]:
        yield (
            f"not here: {_names('launch file', files)}; "
            "give the folder that has it, or correct the include"
        )
    if variables := _named(unresolved, _VARIABLE):
        first = quote(variables[0])
        yield (
            f"not given: {_names('environment variable', variables)}; "
            f"--env {first} takes your own value, --env {first}=VALUE another, --env-all all"
        )
    for each in unresolved:
        if each.what.startswith(_ARGUMENT):
            yield f"{each.what}: {each.why}"


def _packages(unresolved: Sequence[UnresolvedItem]) -> list[str]:
    named = [match[1] for each in unresolved for match in _PACKAGE.finditer(each.why)]
    nodes = [each.what for each in unresolved if each.why.startswith(_NO_SOURCE)]
    return [*named, *(match[1] for what in nodes if (match := _OF_NODE.search(what)))]


def _is_include(item: UnresolvedItem) -> bool:
    return bool(item.missing) and item.what.startswith("include")


def _named(unresolved: Sequence[UnresolvedItem], start: str) -> list[str]:
    return [each.what.removeprefix(start) for each in unresolved if each.what.startswith(start)]


def _names(noun: str, names: Sequence[str]) -> str:
    """Return the names once each, with their noun; of many the first."""
    unique = list(dict.fromkeys(names))
    more = f" and {len(unique) - _MOST_NAMES} more" if len(unique) > _MOST_NAMES else ""
    plural = "" if len(unique) == 1 else "s"
    return f"{noun}{plural} {', '.join(unique[:_MOST_NAMES])}{more}"
