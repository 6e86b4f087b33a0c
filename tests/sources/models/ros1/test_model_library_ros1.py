"""Every model of the library can be evaluated and followed to its source."""

import re

import pytest
from model_cases import site

from rtron.sources.models import load_models, node_interface

MODELS = load_models()
TYPE = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*")


@pytest.mark.parametrize("key", sorted(k for k in MODELS.by_name if k[0] == "node"), ids="/".join)
def test_every_node_is_evaluated_without_parameters(key):
    found = node_interface(MODELS.by_name[key], site(name="/ns/node"))
    for declaration in found.declarations:
        assert declaration.name.startswith("/")
        assert "//" not in declaration.name
        assert declaration.type == "" or TYPE.fullmatch(declaration.type), declaration
        assert declaration.type.endswith("Action") is declaration.kind.startswith("action")
        assert all(e.file.startswith("github.com/") for e in declaration.evidence)


def test_every_explicit_endpoint_names_a_line():
    for key, model in MODELS.by_name.items():
        for entry in model.walk():
            assert entry.kind is None or entry.line or ":" in entry.at, key
