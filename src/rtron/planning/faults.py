"""What is wrong with a plan file: all of it at once, each fault with its line."""

from collections.abc import Collection
from dataclasses import dataclass, field
from difflib import get_close_matches

from rtron.errors import PlanError

_SHOWN = 50
_LONGEST_WORD = 80
_CHOICE = 24


@dataclass(slots=True)
class Faults:
    """The faults of one file, in the order they were found."""

    path: str
    _found: list[tuple[int, str]] = field(default_factory=list)

    def add(self, line: int, message: str) -> None:
        """Note what is wrong on a line (from 1)."""
        self._found.append((line, message))

    def raise_if_any(self) -> None:
        """Raise one PlanError that tells every fault, in the order of the lines."""
        if not self._found:
            return
        (line, first), *others = sorted(set(self._found))
        told = [first, *(f"{self.path}:{line}: {text}" for line, text in others[: _SHOWN - 1])]
        if len(others) >= _SHOWN:
            told.append(f"… and {len(others) - _SHOWN + 1} more")
        help = "`rtron schema plan` describes every key"
        raise PlanError("\n".join(told), path=self.path, line=line, help=help)


def suggestion(word: str, known: Collection[str]) -> str:
    """Return «did you mean …?» with the nearest word, or a short choice where none is near."""
    near = get_close_matches(word[:_LONGEST_WORD], known, n=1)
    if near:
        return f"did you mean {near[0]}?"
    return (
        f"choose from {', '.join(known)}"
        if len(known) <= _CHOICE
        else f"none of the {len(known)} is like it"
    )


def shown(text: str) -> str:
    """Quote a text of the user's, shortened where it is long."""
    return repr(text if len(text) <= _LONGEST_WORD else text[:_LONGEST_WORD] + "…")
