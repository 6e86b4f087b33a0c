"""How many examples a property is tried with: all in `make test-all`, fewer in `make test`."""

from hypothesis import settings

SHORT, WHOLE = 25, 100
"""The examples of a property that does not say how many, in `make test` and `make test-all`."""


def examples(count):
    """Return how many of `count` examples a run tries: as large a part as the profile says."""
    return max(1, count * settings.default.max_examples // WHOLE)
