"""The Python that has the launch library of a ROS 2."""

import shutil
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

_MAX_LINE = 256


def find_pythons(environ: Mapping[str, str]) -> Iterator[str]:
    """Yield where launch may be: the Python of `ros2`, that of the PATH, RTron's own."""
    path = environ.get("PATH", "")
    candidates = [
        _script_interpreter(shutil.which("ros2", path=path)),
        shutil.which("python3", path=path),
    ]
    yield from dict.fromkeys(filter(None, (*candidates, sys.executable)))


def _script_interpreter(script: str | None) -> str | None:
    """Return the interpreter that a script's first line names; None where `env` finds it."""
    if script is None:
        return None
    try:
        with Path(script).open("rb") as stream:
            line = stream.readline(_MAX_LINE).decode(errors="replace")
    except OSError:
        return None
    words = line.removeprefix("#!").split() if line.startswith("#!") else []
    return words[0] if words and "python" in Path(words[0]).name else None
