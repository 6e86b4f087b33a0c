"""The interaction graph of an app that does not run: from its launch files and its source."""

from rtron.sources.static.app import StaticApp, scan_app
from rtron.sources.static.launch_paths import find_launch
from rtron.sources.static.options import ScanOptions

__all__ = ["ScanOptions", "StaticApp", "find_launch", "scan_app"]
