"""Compares what a scan finds in a generated program with what the program surely has."""

from pathlib import Path

from ros2_runs import site

from rtron.sources.code.program_runner import run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Resolution

_CAUGHT = "only an exception handler declares it"


def scan(program, ros, folder):
    """Return what the scan finds in a program, as the node /ns/n."""
    path = Path(folder) / "n.py"
    path.write_text(program.text)
    files = WorkspaceSources(Workspace({"p": Path(folder)}, [Path(folder)]))
    return run_python(path, NodeSite(name="/ns/n") if ros == 1 else site(), files)


def faults(program, interface):
    """Return what is lost without a word, and what is claimed that does not exist."""
    return [*_lost(program, interface), *_claimed(program, interface)]


def found_by_name(program, interface):
    """Return how many of a program's endpoints are found by their names, and how many it has."""
    living = [each for each in program.endpoints if each.lives]
    names = _certain(interface)
    return sum((each.kind, each.name) in names for each in living), len(living)


def _lost(program, interface):
    names, places = _certain(interface), _places(interface)
    for each in program.endpoints:
        known = (each.kind, each.name) in names
        if each.lives and not known and not places.intersection(_lines(each)):
            yield "lost", each


def _claimed(program, interface):
    doubted = {
        f"{note.what.partition(' ')[2]}" for note in interface.unresolved if _CAUGHT in note.why
    }
    expected = {(each.kind, each.name): each for each in program.endpoints}
    for kind, name in sorted(_certain(interface)):
        end = expected.get((kind, name))
        if not (end and end.lives) and f"/ns/{name}" not in doubted:
            yield "claimed", end or (kind, name)


def _certain(interface):
    return {
        (declared.kind.value, declared.name.removeprefix("/ns/"))
        for declared in interface.declarations
        if not declared.implicit and declared.resolution is not Resolution.SYMBOLIC
    }


def _places(interface):
    """Return the lines that notes, and endpoints of which a part of the name is open, tell."""
    open_ends = (d for d in interface.declarations if d.resolution is Resolution.SYMBOLIC)
    told = (*interface.unresolved, *open_ends)
    return {place.line for each in told for place in each.evidence}


def _lines(endpoint):
    first, last = endpoint.lines
    return range(first, last + 1)
