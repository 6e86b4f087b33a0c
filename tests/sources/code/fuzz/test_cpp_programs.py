"""Random programs in C++: what they have is found or noted, and what they have not is not claimed.

FUZZ_PROGRAMS and FUZZ_SEED say how many of each client library there are and where they begin; a
failure names the seed of its program.
"""

import os
from random import Random

import pytest
import ros1_runs
import ros2_runs
from cpp_programs import CONSTRUCTS, LIBRARIES, MAX_PIECES, write_program

from rtron.vocabulary import Resolution

PROGRAMS = int(os.environ.get("FUZZ_PROGRAMS", "15"))
SEED = int(os.environ.get("FUZZ_SEED", "0"))
SEEDS = range(SEED, SEED + PROGRAMS)


def random_program(library, seed):
    random = Random(f"{library} {seed}")
    constructs = random.sample([*CONSTRUCTS.values()], random.randint(1, MAX_PIECES))
    return write_program(LIBRARIES[library], random, constructs)


def scan(program):
    if program.library.ros == 1:
        return ros1_runs.run_text(program.text, "cpp")
    return ros2_runs.run_text(program.text)


def certain(interface):
    """Return the endpoints that are claimed to exist, kind and name, with their types."""
    declared = [each for each in interface.declarations if not each.implicit]
    known = [each for each in declared if each.resolution is not Resolution.SYMBOLIC]
    return {(str(d.kind.value), d.name.removeprefix("/ns")): d.type for d in known}


def noted_lines(interface):
    """Return the lines that are named by notes and by endpoints whose name is not known."""
    unnamed = [d for d in interface.declarations if d.resolution is Resolution.SYMBOLIC]
    items = (*interface.unresolved, *unnamed)
    return {place.line for item in items for place in item.evidence}


def faults(program, interface):
    """Return what is lost in silence, what is invented, and what has a wrong type."""
    found, noted = certain(interface), noted_lines(interface)
    lost = [
        (piece.construct, key)
        for piece in program.pieces
        for key in piece.expected.keys() - found.keys()
        if not piece.lines & noted
    ]
    invented = sorted(found.keys() - program.expected.keys())
    mistyped = [(k, t) for k, t in program.expected.items() if found.get(k, t) != t]
    return {"lost": lost, "invented": invented, "mistyped": mistyped}


NONE = {"lost": [], "invented": [], "mistyped": []}


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("seed", SEEDS)
def test_fuzz_nothing_is_lost_in_silence_and_nothing_invented(library, seed):
    program = random_program(library, seed)
    assert faults(program, scan(program)) == NONE, program.text


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("name", CONSTRUCTS)
def test_each_construct_alone_in_all_its_forms(library, name):
    construct = CONSTRUCTS[name]
    for form in range(construct.forms):
        program = write_program(LIBRARIES[library], Random(SEED), [construct], form)
        assert faults(program, scan(program)) == NONE, program.text
