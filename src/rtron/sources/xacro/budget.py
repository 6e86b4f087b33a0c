"""How much one evaluation may do: a small description can define an endless robot."""

from dataclasses import dataclass

from rtron.sources.launch.common.errors import UnresolvableError

MAX_DEPTH = 100
MAX_FILES = 500
MAX_ELEMENTS = 100_000
MAX_STEPS = 500_000
MAX_CHARACTERS = 16 * 1024 * 1024
MAX_TEXT = 64 * 1024
MAX_WEIGHT = 20_000


@dataclass(slots=True)
class EvaluationBudget:
    """What is spent of each bound; `exceeded_bound` names the first that was passed, for good."""

    elements: int = 0
    steps: int = 0
    characters: int = 0
    files: int = 0
    exceeded_bound: str = ""

    def count_element(self) -> None:
        """Count an element that is evaluated."""
        self.elements += 1
        if self.elements > MAX_ELEMENTS:
            self.exceeded_bound = f"more than {MAX_ELEMENTS} elements are evaluated"

    def count_steps(self, weight: int = 1) -> None:
        """Count a step of an expression; raise UnresolvableError past the bound."""
        self.steps += weight
        if self.steps > MAX_STEPS:
            self.exceeded_bound = f"expressions take more than {MAX_STEPS} steps"
            raise UnresolvableError(self.exceeded_bound)

    def count_text(self, length: int) -> None:
        """Count text that is written; raise UnresolvableError past a bound."""
        self.characters += length
        if self.characters > MAX_CHARACTERS:
            self.exceeded_bound = f"more than {MAX_CHARACTERS} characters are made"
        if self.exceeded_bound or length > MAX_TEXT:
            raise UnresolvableError(self.exceeded_bound or f"a text is longer than {MAX_TEXT}")

    def count_file(self) -> None:
        """Count a file that is read; raise UnresolvableError past the bound."""
        self.files += 1
        if self.files > MAX_FILES:
            raise UnresolvableError(f"more than {MAX_FILES} files are included")
