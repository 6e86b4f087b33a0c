"""Launch arguments that a person gives and no launch file declares: often a slip of the pen."""

from collections.abc import Collection, Iterable, Iterator

from rtron.errors import suggestion
from rtron.vocabulary import UnresolvedCause, UnresolvedItem
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

_NEAR = ": did you mean"


def undeclared_arguments(
    passed: Iterable[str], declared: Collection[str]
) -> Iterator[UnresolvedItem]:
    """Yield a note on each argument that is not declared, with the nearest one that is.

    Where `*` is declared, what was not read may declare any: then only a slip of the pen is noted.
    """
    known = sorted(set(declared) - {UNKNOWN_NAME})
    for name in sorted(set(passed) - set(declared)):
        near = f": {suggestion(name, known)}" if known else ""
        if UNKNOWN_NAME not in declared or near.startswith(_NEAR):
            what, why = f"launch argument {name}", f"no launch file declares it{near}"
            yield UnresolvedItem(what=what, why=why, cause=UnresolvedCause.ARGUMENT)
