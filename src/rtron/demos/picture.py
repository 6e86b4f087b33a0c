"""A picture of what a command prints, as SVG that loads nothing from elsewhere."""

import re
from io import StringIO

from rich.console import Console
from rich.text import Text

WIDTH = 96
_FONT_FACE = re.compile(r"@font-face \{.*?\}\s*", re.DOTALL)


def terminal_picture(printed: str, title: str) -> str:
    """Return an SVG of a terminal that shows `printed`; ANSI colours are kept."""
    console = Console(record=True, width=WIDTH, file=StringIO())
    console.print(Text.from_ansi(printed), soft_wrap=False)
    return _FONT_FACE.sub("", console.export_svg(title=title, unique_id="rtron"))
