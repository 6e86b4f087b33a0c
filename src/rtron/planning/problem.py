"""What is wrong between a plan and the app that it is for."""

from dataclasses import dataclass

from rtron.vocabulary import StringEnum


class ProblemLevel(StringEnum):
    """Whether a problem keeps a plan from being used."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class PlanProblem:
    """One thing that is wrong; `location` names the coordination node or topic."""

    level: ProblemLevel
    location: str
    message: str

    def __str__(self) -> str:
        return f"{self.level}: {self.location}: {self.message}"
