"""What a visit has found so far, as the JSON that tells of it."""

from dataclasses import asdict, dataclass, field
from typing import Any, TypeAlias

from .locations import Location

Values: TypeAlias = dict[str, Any]

_OPEN, _CLOSE = "rtron_command_", "_output"
"""Around a command's number: launch_ros looks whether a name with it is legal."""


@dataclass
class VisitRecord:
    """`commands` are those that were not run: a mark with a number stands for what one prints."""

    starts: list[Values] = field(default_factory=list)
    arguments: list[Values] = field(default_factory=list)
    includes: list[Values] = field(default_factory=list)
    notes: list[Values] = field(default_factory=list)
    commands: list[str] = field(default_factory=list)
    error: Values | None = None
    missing: str = ""

    def mark_command(self, command: str) -> str:
        """Return what stands for what a command would print."""
        if command not in self.commands:
            self.commands.append(command)
        return f"{_OPEN}{self.commands.index(command)}{_CLOSE}"

    def command_of_mark(self, text: str) -> str:
        """Return the command whose mark stands in a text; empty for none."""
        number = text.partition(_OPEN)[2].partition(_CLOSE)[0]
        known = number.isdigit() and int(number) < len(self.commands)
        return self.commands[int(number)] if known else ""

    def note(self, why: str, location: Location) -> None:
        """Keep what is not known."""
        self.notes.append({"why": why, "place": location_fields(location)})

    def document(self) -> Values:
        """Return all that was found."""
        return {"schema": "rtron.visit/1", **asdict(self)}


def location_fields(location: Location) -> Values:
    """Return a place as it is written down."""
    return {"file": location[0], "line": location[1]}
