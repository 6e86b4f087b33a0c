"""Under which name an action is found: since Kilted a remap rule for it counts."""

import pytest

from rtron.sources.declaration import Declaration, DeclarationKind
from rtron.sources.static.ros2.endpoints import RemapRules, graph_entities

GOALS = "/_action/send_goal"


@pytest.mark.parametrize(
    ("distribution", "source", "name"),
    [
        ("jazzy", "/go", "/go"),
        ("kilted", "/go", "/base/go"),
        ("rolling", "/go", "/base/go"),
        ("", "/go", "/base/go"),
        ("jazzy", f"/go{GOALS}", "/base/go"),
        ("kilted", f"/go{GOALS}", "/base/go"),
        ("kilted", "/other", "/go"),
    ],
)
def test_an_action_has_the_name_that_its_remap_gives_it(distribution, source, name):
    target = "/base/go" + (GOALS if source.endswith(GOALS) else "")
    rules = RemapRules(((source, target),), "/n", distribution)
    declared = Declaration(kind=DeclarationKind.ACTION_CLIENT, name="/go", type="x/action/Go")
    (action,) = graph_entities("/n", [declared], rules)
    assert action.name == name
