"""Where the demo app lies, for each ROS."""

from pathlib import Path

APPS = Path(__file__).parents[1] / "apps"
LOGIC = APPS / "logic"
APP_NAME = "tb3_demo"
"""The app's own name, and that of the developer's own package."""
_LAUNCH = {1: "tb3_demo.launch", 2: "tb3_demo.launch.xml"}


def first_party_packages(ros: int) -> Path:
    """Return the folder of the developer's own packages."""
    return APPS / f"ros{ros}"


def third_party_packages(ros: int) -> Path:
    """Return the folder of the packages that the developer has from elsewhere."""
    return APPS / "third_party" / f"ros{ros}"


def launch_file(ros: int) -> Path:
    """Return the launch file that starts the whole app, unguarded."""
    return first_party_packages(ros) / APP_NAME / "launch" / _LAUNCH[ros]
