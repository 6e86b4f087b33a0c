"""What is wrong with a plan file: all of it at once, each fault with its line."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches

from rtron.errors import PlanError

_SHOWN = 50
_LONGEST_WORD = 80
_CHOICE = 24
_HELP = "`rtron schema plan` describes every key"


@dataclass(slots=True)
class Faults:
    """The faults of one file, in the order they were found."""

    path: str
    _found: list[tuple[int, str, str]] = field(default_factory=list)

    def add(self, line: int, message: str, help: str = "") -> None:
        """Note what is wrong on a line (from 1), and what to do about it."""
        self._found.append((line, message, help))

    def raise_if_any(self) -> None:
        """Raise one PlanError that tells every fault, in the order of the lines.

        The help of a single fault is the error's; that of several stands with each of them.
        """
        found = sorted(set(self._found))
        if len(found) == 1:
            ((line, message, help),) = found
            raise PlanError(message, path=self.path, line=line, help=help or _HELP)
        if found:
            raise PlanError(self._told(found), path=self.path, line=found[0][0], help=_HELP)

    def _told(self, found: Sequence[tuple[int, str, str]]) -> str:
        texts = [(line, f"{text} ({help})" if help else text) for line, text, help in found]
        (_, first), *others = texts[:_SHOWN]
        told = [first, *(f"{self.path}:{line}: {text}" for line, text in others)]
        if len(found) > _SHOWN:
            told.append(f"… and {len(found) - _SHOWN} more")
        return "\n".join(told)


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
