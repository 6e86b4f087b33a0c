"""Lets the tests import the script that writes the policies' pages."""

from hypothesis import Phase, settings

# For mutation testing, where only whether something fails counts, and not the smallest example.
settings.register_profile(
    "mutation",
    derandomize=True,
    database=None,
    phases=[Phase.explicit, Phase.generate],
    deadline=None,
)
