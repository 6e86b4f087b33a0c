"""Write docs/images/scan.svg, the README's picture, from the graph that `make demo` scanned."""

import os
import subprocess
import sys
from pathlib import Path

from rtron.demos.picture import WIDTH, terminal_picture

ROOT = Path(__file__).parent.parent
GRAPH = Path("build", "demo", "graph.json")
PICTURE = ROOT / "docs" / "images" / "scan.svg"


def main() -> int:
    """Scan the demo's graph and keep what a terminal shows."""
    if not (ROOT / GRAPH).exists():
        print(f"{GRAPH} is not there: run `make demo` first", file=sys.stderr)
        return 1
    command = ["rtron", "scan", str(GRAPH), "--fail-on", "never"]
    terminal = os.environ | {"FORCE_COLOR": "1", "COLUMNS": str(WIDTH)}
    done = subprocess.run(  # noqa: S603 - the command is ours
        [sys.executable, "-m", *command],
        cwd=ROOT,
        env=terminal,
        check=True,
        capture_output=True,
        text=True,
    )
    PICTURE.parent.mkdir(parents=True, exist_ok=True)
    PICTURE.write_text(terminal_picture(done.stdout, " ".join(command[:3])), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
