"""Lets the tests import the script that writes the policies' pages."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
