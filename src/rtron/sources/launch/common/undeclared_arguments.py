"""Launch arguments that a person gives and no launch file declares: often a slip of the pen."""

from collections.abc import Collection, Iterable, Iterator

from rtron.errors import suggestion
from rtron.vocabulary import UnresolvedItem

ARGUMENT = "launch argument "
"""What a note on an argument begins with; its name follows."""


def undeclared_arguments(
    passed: Iterable[str], declared: Collection[str]
) -> Iterator[UnresolvedItem]:
    """Yield a note on each argument that is not declared, with the nearest one that is."""
    for name in sorted(set(passed) - set(declared)):
        near = f": {suggestion(name, sorted(declared))}" if declared else ""
        yield UnresolvedItem(what=f"{ARGUMENT}{name}", why=f"no launch file declares it{near}")
