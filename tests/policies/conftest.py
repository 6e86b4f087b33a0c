"""Lets the tests import the script that writes the policies' pages."""

from hypothesis import Phase, settings

# For coverage, where one example that goes through a branch is as good as many.
settings.register_profile("coverage", derandomize=True, max_examples=10, deadline=None)
# For mutation testing, where only whether something fails counts, and not the smallest example.
settings.register_profile(
    "mutation",
    derandomize=True,
    database=None,
    phases=[Phase.explicit, Phase.generate],
    deadline=None,
)
