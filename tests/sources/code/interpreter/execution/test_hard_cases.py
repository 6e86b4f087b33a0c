"""Every hard case of static extraction: just what each node declares, and nothing else."""

import pytest
from hard_cases import APP, app, expected, interface_as_expected, run_hard_case


@pytest.mark.parametrize("node", expected())
def test_a_node_declares_just_what_it_would(node):
    assert interface_as_expected(run_hard_case(node)) == expected()[node]


@pytest.mark.parametrize("node", expected())
def test_what_never_runs_is_not_found(node):
    interface = run_hard_case(node)
    assert [one.name for one in interface.declarations if "dead" in one.name] == []


def test_every_node_of_the_launch_has_expectations():
    _, tree = app()
    assert tree.unresolved == ()
    assert {node.name for node in tree.nodes()} == {*expected(), "/robot/manager"}


def test_there_is_dead_code_that_could_be_found():
    sources = [path.read_text("latin-1") for path in APP.rglob("*.[cp][py]*") if path.is_file()]
    assert sum(text.count('"dead_') + text.count("'dead_") for text in sources) > 30


@pytest.mark.parametrize("node", [name for name in expected() if "leaving" not in name])
def test_nothing_of_a_node_stays_unresolved(node):
    expected_notes = ("nothing that is seen calls", "cannot be read", "is not given")
    whys = [note.why for note in run_hard_case(node).unresolved]
    assert [why for why in whys if not any(note in why for note in expected_notes)] == []
