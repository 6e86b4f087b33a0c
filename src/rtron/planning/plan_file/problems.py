"""What is wrong with a plan file: all of it at once, each fault with its line."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from rtron.errors import PlanError

_MAX_SHOWN = 50
_MAX_WORD_LENGTH = 80
_HELP = "`rtron schema plan` describes every key"


@dataclass(slots=True)
class FileProblems:
    """The faults of one file, in the order they were found."""

    path: str
    _entries: list[tuple[int, str, str]] = field(default_factory=list)

    def add(self, line: int, message: str, help: str = "") -> None:
        """Note what is wrong on a line (from 1), and what to do about it."""
        self._entries.append((line, message, help))

    def raise_if_any(self) -> None:
        """Raise one PlanError that tells every fault, in the order of the lines.

        The help of a single fault is the error's; that of several stands with each of them.
        """
        problems = sorted(set(self._entries))
        if len(problems) == 1:
            ((line, message, help),) = problems
            raise PlanError(message, path=self.path, line=line, help=help or _HELP)
        if problems:
            raise PlanError(
                self._message(problems), path=self.path, line=problems[0][0], help=_HELP
            )

    def _message(self, problems: Sequence[tuple[int, str, str]]) -> str:
        texts = [(line, f"{text} ({help})" if help else text) for line, text, help in problems]
        (_, first), *others = texts[:_MAX_SHOWN]
        lines = [first, *(f"{self.path}:{line}: {text}" for line, text in others)]
        if len(problems) > _MAX_SHOWN:
            lines.append(f"… and {len(problems) - _MAX_SHOWN} more")
        return "\n".join(lines)


def quoted(text: str) -> str:
    """Quote a text of the user's, shortened where it is long."""
    return repr(text if len(text) <= _MAX_WORD_LENGTH else text[:_MAX_WORD_LENGTH] + "…")
