"""Each model of both libraries can be read, and leads to what it uses."""

import ast
import re

import pytest
from model_cases import model_texts

from rtron.sources.models import ROS2_LIBRARY, load_models

_BRACES = re.compile(r"\{([^{}]*)\}")


@pytest.fixture(scope="module", params=[(), (ROS2_LIBRARY,)], ids=["ros1", "ros2"])
def models(request):
    return load_models(*request.param)


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
