"""Programs in C++ against a real ROS 1, each compiled once for all tests of a run."""

import fcntl
import subprocess
from pathlib import Path

_HERE = Path(__file__).parent


def compiled(folder, name, *packages):
    """Return the program of tests/ros1/`name`.cpp in a folder; who comes first compiles it."""
    program = folder / name
    with (folder / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not program.exists():
            _compile(_HERE / f"{name}.cpp", program, packages)
    return program


def _compile(source, program, packages):
    words = ["pkg-config", "--cflags", "--libs", *packages]
    flags = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    subprocess.run(["g++", "-std=c++17", source, "-o", program, *flags], check=True)
