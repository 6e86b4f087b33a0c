"""The environment of a launch: what the user gives of it, and what is read of it in vain."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rtron.vocabulary import UnresolvedCause, UnresolvedItem


@dataclass(eq=False, slots=True)
class LaunchEnvironment(Mapping[str, str]):
    """The variables that count, and in `unset` those that a launch reads and nobody gives.

    `unset` has what counts in a variable's place, None for nothing.
    """

    given: Mapping[str, str]
    unset: dict[str, str | None] = field(default_factory=dict)

    def __getitem__(self, name: str) -> str:
        return self.given[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.given)

    def __len__(self) -> int:
        return len(self.given)

    def notes(self) -> Iterator[UnresolvedItem]:
        """Yield what is not given, and what counts instead."""
        for name, default in self.unset.items():
            what, cause = f"environment variable {name}", UnresolvedCause.UNSET_VARIABLE
            yield UnresolvedItem(what=what, why=unset_reason(default), cause=cause)


def unset_reason(default: str | None) -> str:
    """Return what counts in place of a variable that is not given."""
    if not default:
        return "is not given" if default is None else "is not given, so it is empty"
    return f"is not given; `{default}` counts"


def look_up(environ: Mapping[str, str], name: str, default: str | None = None) -> str | None:
    """Return a variable that a launch file reads, or else the default; it is noted if not given."""
    if name not in environ and isinstance(environ, LaunchEnvironment):
        environ.unset.setdefault(name, default)
    return environ.get(name, default)
