"""A real app whose guard is linked to a running service."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[3]))
