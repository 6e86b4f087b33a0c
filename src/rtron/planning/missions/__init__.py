"""Missions that ship with RTron: the paper's examples of mission-specific rules, as plans.

Each is a plan of its own that can be checked, replayed and copied from (paper section 4.3, table
of mission-specific risks, and the MSR case of section 7.4).
"""

from importlib.resources import files

_FOLDER = files(__name__)
MISSIONS = tuple(
    sorted(
        each.name.removesuffix(".yaml") for each in _FOLDER.iterdir() if each.name[-4:] == "yaml"
    )
)


def mission_text(name: str) -> str:
    """Return a mission's plan as YAML; the comment at its head says what it is about."""
    return (_FOLDER / f"{name}.yaml").read_text(encoding="utf-8")


def mission_summary(name: str) -> str:
    """Return what a mission is about, in a line."""
    return mission_text(name).split("\n", 1)[0].removeprefix("# ")
