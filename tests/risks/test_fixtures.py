"""The fixtures in JSON are those in Python."""

import pytest
from write_json import FIXTURES, FOLDER, as_text

from rtron.risks import discover_risks
from rtron.sources.graph_json import read_graph


@pytest.mark.parametrize("name", FIXTURES)
def test_the_json_is_fresh(name):
    written = (FOLDER / name).read_text(encoding="utf-8")
    assert written == as_text(FIXTURES[name]), "run tests/fixtures/write_json.py"


@pytest.mark.parametrize("name", FIXTURES)
def test_the_json_reads_as_the_same_graph(name):
    read = read_graph(FOLDER / name)
    assert read == FIXTURES[name]
    assert discover_risks(read) == discover_risks(FIXTURES[name])
