"""Lets the tests import the fixtures, and the script that writes the rules' pages."""

import sys
from pathlib import Path

for folder in ("tests/fixtures", "scripts"):
    sys.path.insert(0, str(Path(__file__).parents[2] / folder))
