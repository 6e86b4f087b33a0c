"""Where the demo app lies, for each ROS."""

from pathlib import Path

APPS = Path(__file__).parents[1] / "apps"
LOGIC = APPS / "logic"
NAME = "tb3_demo"
"""The app's own name, and that of the developer's own package."""
_LAUNCH = {1: "tb3_demo.launch", 2: "tb3_demo.launch.xml"}


def own_packages(ros: int) -> Path:
    """Return the folder of the developer's own packages."""
    return APPS / f"ros{ros}"


def other_packages(ros: int) -> Path:
    """Return the folder of the packages that the developer has from elsewhere."""
    return APPS / "others" / f"ros{ros}"


def launch_file(ros: int) -> Path:
    """Return the launch file that starts the whole app, unguarded."""
    return own_packages(ros) / NAME / "launch" / _LAUNCH[ros]
