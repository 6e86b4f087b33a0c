import pytest
from rich.console import Console


@pytest.fixture
def printed():
    """Print a report on a page and return what stands there."""

    def print_on(report, width=80, **keys):
        console = Console(width=width, **keys)
        with console.capture() as captured:
            console.print(report, soft_wrap=True)
        return captured.get()

    return print_on
