"""The supervisor that a guard starts, when it has lost its own: only for this guard."""

from rtron.guard.supervision import supervisor_program


def main(numbers: str) -> None:
    """Supervise the guard that runs; end with the exit code, if there is none with an error."""
    supervisor_program.main(numbers, is_backup=True)
