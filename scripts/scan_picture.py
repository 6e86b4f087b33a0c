"""Write docs/images/scan.svg, the README's picture: what a scan of the demo app's source shows."""

import os
import re
import subprocess
import sys
from io import StringIO
from pathlib import Path

from rich.console import Console
from rich.text import Text

from rtron.demos.runtime.isolation import first_party_packages, third_party_packages

PICTURE = Path(__file__).parent.parent / "docs" / "images" / "scan.svg"
LAUNCH = ("--launch", "tb3_demo/tb3_demo.launch")
WIDTH = 96
FONT_FACE = re.compile(r"@font-face \{.*?\}\s*", re.DOTALL)
"""What would load a font from elsewhere."""


def main() -> None:
    """Scan the demo app and keep what a terminal shows."""
    others = third_party_packages(1)
    terminal = {"FORCE_COLOR": "1", "COLUMNS": str(WIDTH), "ROS_PACKAGE_PATH": str(others)}
    done = subprocess.run(  # noqa: S603 - the command is ours
        [sys.executable, "-m", "rtron", "scan", ".", *LAUNCH, "--fail-on", "never"],
        cwd=first_party_packages(1),
        env=os.environ | terminal,
        check=True,
        capture_output=True,
        text=True,
    )
    shown = done.stdout.replace(f"{others}{os.sep}", "")
    PICTURE.write_text(terminal_picture(shown, f"rtron scan src {' '.join(LAUNCH)}"), "utf-8")


def terminal_picture(printed: str, title: str) -> str:
    """Return an SVG of a terminal that shows `printed`; ANSI colours are kept."""
    console = Console(record=True, width=WIDTH, file=StringIO())
    console.print(Text.from_ansi(printed), soft_wrap=False)
    return FONT_FACE.sub("", console.export_svg(title=title, unique_id="rtron"))


if __name__ == "__main__":
    main()
