"""YAML that others wrote: bounded before it is read, its errors with their lines."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import yaml

from rtron.errors import InputError

SAFE_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True, slots=True, kw_only=True)
class YamlRules:
    """What a YAML text may have; `max_values` 0 is no limit.

    `refusal`, `help` and `error` are for the message: `has` anchors, or `a plan has no` anchors.
    """

    max_depth: int
    max_values: int = 0
    allows_aliases: bool = False
    allows_tags: bool = True
    refusal: str = "has"
    help: str = ""
    error: type[InputError] = InputError

    def violation(self, event: yaml.Event, depth: int, count: int) -> str:
        """Return what of an event is not allowed, empty where it is."""
        has_anchor = isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None)
        if has_anchor and not self.allows_aliases:
            return "anchors and aliases"
        if getattr(event, "tag", None) and not self.allows_tags:
            return "tags (`!…`)"
        if self.max_values and count > self.max_values:
            return f"more than {self.max_values} values"
        return f"more than {self.max_depth} levels" if depth > self.max_depth else ""


def check_yaml(
    text: str | bytes,
    path: str,
    rules: YamlRules,
    *,
    first_line: int = 1,
    loader: Any = SAFE_LOADER,  # noqa: ANN401 - PyYAML's loaders share no type
) -> None:
    """Raise InputError, with the line, for the first violation of the rules."""
    depth = 0
    for count, event in enumerate(yaml.parse(text, Loader=loader), 1):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        violation = rules.violation(event, depth, count)
        if violation:
            line = first_line + event.start_mark.line if event.start_mark else 0
            message = f"{rules.refusal} {violation}"
            raise rules.error(message, path=path, line=line, help=rules.help)


def compose_yaml(text: str | bytes, path: str, rules: YamlRules) -> yaml.Node | None:
    """Return a text's tree, None for an empty one; raise InputError if it is none or unsafe."""
    with yaml_errors(path, error_type=rules.error):
        check_yaml(text, path, rules)
        root: yaml.Node | None = yaml.compose(text, Loader=SAFE_LOADER)
    return root


@contextmanager
def yaml_errors(
    path: str, first_line: int = 1, error_type: type[InputError] = InputError
) -> Iterator[None]:
    """Raise an InputError for what PyYAML raises: with its line, or that where the text begins."""
    try:
        yield
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = first_line + (mark.line if mark else 0)
        raise error_type(f"not YAML: {error.problem}", path=path, line=line) from None
    except (yaml.YAMLError, ValueError, TypeError) as error:
        why = str(error).partition("\n")[0]
        raise error_type(f"not YAML: {why}", path=path, line=first_line) from None
