"""What the random programs say of themselves is true: compiled against roscpp, they have it.

Each part takes some of the constructs, so that all are compiled once; FUZZ_SEED chooses how they
are written. Clients of services are known to no master, so they are not looked at.
"""

import subprocess
from random import Random

import pytest
from cpp_programs import CONSTRUCTS, ROSCPP, write_program
from harness import Ros1, wait_for
from test_cpp_programs import NONE, SEED, faults, scan

PARTS = 6
COMPILE_LIMIT_S = 240
SIDES = ("publish", "subscribe", "service")
OWN = {
    ("publish", "/rosout"),
    ("service", "/fuzz/get_loggers"),
    ("service", "/fuzz/set_logger_level"),
}
"""What every node of roscpp has."""


def compiled(program, folder):
    """Return the program that g++ makes."""
    source, binary = folder / "fuzz.cpp", folder / "fuzz"
    source.write_text(program.text)
    words = ("pkg-config", "--cflags", "--libs", "roscpp")
    flags = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    command = ["g++", "-std=c++20", "-w", "-O0", source, "-o", binary, *flags]
    made = subprocess.run(
        command, capture_output=True, text=True, timeout=COMPILE_LIMIT_S, check=False
    )
    assert made.returncode == 0, made.stderr[:4000]
    return binary


def registered(ros):
    """Return what the node has, as the master knows it."""
    sides = zip(SIDES, ros.state(), strict=True)
    return {
        (kind, name) for kind, side in sides for name, nodes in side.items() if "/fuzz" in nodes
    }


@pytest.mark.ros1
@pytest.mark.long
@pytest.mark.parametrize("part", range(PARTS))
def test_a_compiled_program_has_what_it_says(part, tmp_path):
    random = Random(f"compiled {SEED} {part}")
    constructs = [*CONSTRUCTS.values()][part::PARTS]
    program = write_program(ROSCPP, random, constructs)
    binary = compiled(program, tmp_path)
    expected = {key for key in program.expected if key[0] in SIDES}
    with Ros1(tmp_path) as ros:
        node = ros.spawn(binary)
        wait_for(lambda: node.ended or expected <= registered(ros), what="all that it should have")
        assert registered(ros) - OWN == expected, node.log
    assert faults(program, scan(program)) == NONE
