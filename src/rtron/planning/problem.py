"""What is wrong between a plan and the app that it is for."""

from dataclasses import dataclass

from rtron.vocabulary import Word


class Level(Word):
    """Whether a problem keeps a plan from being used."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong; `where` names the coordination node or topic."""

    level: Level
    where: str
    message: str

    def __str__(self) -> str:
        return f"{self.level}: {self.where}: {self.message}"
