"""How risks, findings and reports speak of nodes and topics."""

from collections.abc import Sequence

_SHOWN = 3


def join_names(names: Sequence[str], nobody: str = "nobody") -> str:
    """Join names as a sentence does, the first few of many."""
    if not names:
        return nobody
    shown = list(names[:_SHOWN])
    if len(names) > _SHOWN:
        shown.append(f"{len(names) - _SHOWN} more")
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


def conjugate(names: Sequence[str], plural: str) -> str:
    """Bend a regular verb to the number of its subjects."""
    if len(names) > 1:
        return plural
    return f"{plural}es" if plural.endswith(("sh", "ch")) else f"{plural}s"


def both_or_all(names: Sequence[str]) -> str:
    """Say «both» of two and «all» of more."""
    return "both" if len(names) == 2 else "all"  # noqa: PLR2004 - two is what both means
