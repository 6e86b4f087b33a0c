"""A part of the measurements, and whom it tells what it does."""

from collections.abc import Callable, Iterator

from bench.common.testbed import Testbed
from figures.figure import Figure

ReportProgress = Callable[[str], None]
"""Tells what is being done."""
Part = Callable[[Testbed, ReportProgress], Iterator[Figure]]
"""Measures, and gives each figure as soon as it is known."""
