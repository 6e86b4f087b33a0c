"""Each model of both libraries can be read, and leads to what it uses."""

import ast
import re
from pathlib import Path

import pytest
import yaml
from model_cases import model_texts

from rtron.sources.models import ROS2_LIBRARY, load_models

LIBRARIES = {"ros1": (), "ros2": (ROS2_LIBRARY,)}
CASES = Path(__file__).parents[1] / "cases"
_BRACES = re.compile(r"\{([^{}]*)\}")


@pytest.fixture(scope="module", params=LIBRARIES)
def ros(request):
    return request.param


@pytest.fixture(scope="module")
def models(ros):
    return load_models(*LIBRARIES[ros])


def test_every_expression_parses(models):
    for model in models.by_name.values():
        for kind, text in model_texts(model):
            for expression in [text] if kind == "expression" else _BRACES.findall(text):
                assert ast.parse(expression.strip(), mode="eval").body


def test_every_literal_use_leads_to_a_model_that_gets_what_it_needs(models):
    for key, model in models.by_name.items():
        for entry in model.walk():
            if entry.uses is not None and "{" not in entry.uses:
                used = models.find(entry.uses)
                assert used is not None, (key, entry.uses)
                assert set(entry.passed) == set(used.needs), (key, entry.uses)


def test_a_library_has_the_models_that_its_list_names(ros, models):
    found = {
        kind: {name for each, name in models.by_name if each == kind} for kind, _ in models.by_name
    }
    plugins = yaml.safe_load((CASES / f"{ros}_models.yaml").read_text())
    for file in plugins.pop("gazebo_plugin", "").split():
        assert models.gazebo_plugin(file) is not None, file
    assert {kind: {*names.split()} - found[kind] for kind, names in plugins.items()} == {
        kind: set() for kind in plugins
    }
