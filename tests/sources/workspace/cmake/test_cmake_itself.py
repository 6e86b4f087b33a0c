"""Programs that cmake itself carries out: what it makes is found, or something is noted."""

import shutil
import subprocess

import pytest
from cmake_programs import random_program
from file_tree import write
from workspace_tree import evaluate_cmake

from example_budget import examples

CMAKE = shutil.which("cmake")
HEAD = """cmake_policy(VERSION 3.10)
function(add_executable name)
message("made ${name}|${ARGN}")
endfunction()
"""
SOURCES = "a.cpp b.cpp sub/c.cpp"


def made_by_cmake(folder, program):
    """Return the targets that cmake makes, with their sources; None if it refuses the program."""
    write(folder, dict.fromkeys(SOURCES.split(), ""))
    script = folder / "run.cmake"
    script.write_text(HEAD + program)
    done = subprocess.run(
        [CMAKE, "-P", script], capture_output=True, text=True, timeout=30, check=False
    )
    if done.returncode:
        return None
    made = {}
    for line in done.stderr.splitlines():
        name, _, sources = line.removeprefix("made ").partition("|")
        made.setdefault(name, set()).update(s for s in sources.split(";") if s in SOURCES.split())
    return made


def silent_losses(folder, program):
    """Return what of a program is lost without a note; None with one, or if cmake refuses it."""
    made = made_by_cmake(folder, program)
    contents = evaluate_cmake(folder, program, SOURCES)
    if made is None or any("generated or missing" not in n.why for n in contents.unresolved):
        return None
    found = {
        target.name: {str(path.relative_to(folder)) for path in target.sources}
        for target in contents.targets
    }
    return [
        (name, sources - found.get(name, set()))
        for name, sources in made.items()
        if name and not sources <= found.get(name, {None})
    ]


@pytest.mark.skipif(CMAKE is None, reason="cmake is not installed")
def test_nothing_that_cmake_makes_is_lost_silently(tmp_path):
    seeds, silent = examples(400), 0
    for seed in range(seeds):
        program = random_program(seed)
        losses = silent_losses(tmp_path, program)
        assert not losses, (seed, program)
        silent += losses is not None
    assert silent > seeds // 2
