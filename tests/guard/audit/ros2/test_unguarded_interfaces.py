"""Services, actions and parameters of ROS 2 that no planned path leads through."""

from dataclasses import replace

import pytest
from domain_scene import CLOSED, NAVIGATE, NODES, action_plan, base_plan, verified

from rtron.vocabulary import Service

SET = "rcl_interfaces/srv/SetParameters"
HARMLESS = (
    ("describe_parameters", "rcl_interfaces/srv/DescribeParameters"),
    ("get_parameters", "rcl_interfaces/srv/GetParameters"),
    ("get_type_description", "type_description_interfaces/srv/GetTypeDescription"),
    ("get_state", "lifecycle_msgs/srv/GetState"),
)


def told(*services, plan=None):
    rows = [Service(node=node, name=name, type=type) for node, name, type in services]
    found = verified(CLOSED, NODES, rows, plan=plan)
    return {each.what: each.why for each in found.unguarded}


def test_parameters_of_planned_nodes():
    names = ("/driver", "/nav", "/teleop_7", "/camera")
    rows = [(node, f"{node}/set_parameters", SET) for node in names]
    assert told(*rows) == {
        "/driver/set_parameters": "changes parameters of /driver, behind the guard",
        "/nav/set_parameters": "changes parameters of /nav, which the guard listens to",
        "/teleop_7/set_parameters": "changes parameters of /teleop_7, which the guard listens to",
    }
    row = ("/nav", "/nav/set_parameters_atomically", f"{SET}Atomically")
    assert list(told(row)) == ["/nav/set_parameters_atomically"]


def test_lifecycles_of_planned_nodes():
    change = "lifecycle_msgs/srv/ChangeState"
    assert told(("/nav", "/nav/change_state", change), ("/map", "/map/change_state", change)) == {
        "/nav/change_state": "starts and stops /nav, which the guard listens to"
    }


def test_services_of_successors_only():
    trigger = "std_srvs/srv/Trigger"
    assert told(("/driver", "/reset", trigger), ("/nav", "/replan", trigger)) == {
        "/reset": "is a service of /driver, behind the guard"
    }


@pytest.mark.parametrize(("name", "type"), HARMLESS)
def test_what_cannot_move_anything_is_not_listed(name, type):
    assert told(("/driver", f"/driver/{name}", type)) == {}


def test_containers_of_any_name():
    load, unload = (f"composition_interfaces/srv/{name}Node" for name in ("Load", "Unload"))
    rows = (("/box", "/box/_container/load_node", load), ("/box", "/box/unload", unload))
    assert told(*rows) == {
        "/box/_container/load_node": "puts nodes into the process of /box",
        "/box/unload": "takes nodes out of the process of /box",
    }


def served(node, action):
    part = "nav2_msgs/action/NavigateToPose"
    names = ("send_goal", "SendGoal"), ("cancel_goal", "x"), ("get_result", "GetResult")
    return [(node, f"{action}/_action/{one}", f"{part}_{other}") for one, other in names]


def test_an_action_of_a_successor_is_listed_once_by_its_own_name():
    why = "is an action of /driver, behind the guard, which the plan does not guard"
    assert told(*served("/driver", "/dock"), *served("/nav", "/follow")) == {"/dock": why}


def test_an_action_that_the_plan_guards_is_not():
    rows = [*served("/server", NAVIGATE), *served("/server", f"/rtron{NAVIGATE}/out")]
    assert told(*rows, plan=action_plan()) == {}


def test_the_guards_own_services_are_not_and_what_was_accepted_is():
    plan = replace(base_plan(), accept_unenforceable=("/arm",))
    grcn = ("/rtron/grcn_cmd_vel", "/rtron/grcn_cmd_vel/set_parameters", SET)
    assert told(grcn, plan=plan) == {"/arm": "cannot be closed, and was accepted"}
