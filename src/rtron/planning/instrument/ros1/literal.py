"""A string as it may stand in `$(eval …)`."""

import re

_DOUBLED = re.compile(r"_(?=_)")


def eval_literal(text: str) -> str:
    """Return a Python literal with no two underscores together, which roslaunch refuses."""
    escaped = text.replace("\\", r"\\").replace("'", r"\'")
    return "('" + _DOUBLED.sub("_' '", escaped) + "')"
