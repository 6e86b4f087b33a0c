"""Which names of readers an inventory has."""

import pytest

from evaluation.common.movers import missing_names


def inventory(*commands):
    return [{"commands": [{"name": name, "means": means} for name, means in commands]}]


@pytest.mark.parametrize(
    ("command", "listed", "missing"),
    [
        (("/cmd_vel", "topic"), ["/cmd_vel", "/other"], ["/other"]),
        (("/arm_{size}/go", "service"), ["/arm_1/go", "/arm_1/x/go"], ["/arm_1/x/go"]),
        (("/nav.max_vel", "parameter"), ["/nav/P/set_parameters", "/nav/x"], ["/nav/x"]),
        (("/{name}", "topic"), ["/x"], ["/x"]),
        (("/nav/set_parameters", "parameter"), ["/nav/set_parameters", "/nav"], ["/nav"]),
    ],
)
def test_what_an_inventory_lacks(command, listed, missing):
    assert missing_names(inventory(command), listed) == missing


def test_an_empty_inventory_lacks_all():
    assert missing_names([], ["/a"]) == ["/a"]
