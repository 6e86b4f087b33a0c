"""Python's two ways to format a string, without what could make the result large."""

import re
from typing import Any

from rtron.sources.launch.common.errors import UnresolvableError

_FIELD = re.compile(r"\{\w*(:[<>=^+ 0]*\d{0,3}(\.\d{1,2})?[a-z%]?)?\}")
_DIRECTIVE = re.compile(r"%[-+ 0#]*\d{0,3}(\.\d{1,2})?[a-z%]")


def format_braces(template: str, *values: Any) -> str:  # noqa: ANN401 - whatever an expression makes
    """Return `template.format(*values)`; raise UnresolvableError for more than plain fields."""
    if set("{}") & set(_FIELD.sub("", template)):
        raise UnresolvableError(f"format {template!r} is not of the kind that is evaluated here")
    return template.format(*values)


def format_percent(template: str, values: Any) -> str:  # noqa: ANN401 - as above
    """Return `template % values`; raise UnresolvableError for more than plain directives."""
    if "%" in _DIRECTIVE.sub("", template):
        raise UnresolvableError(f"format {template!r} is not of the kind that is evaluated here")
    result: str = template % values
    return result
