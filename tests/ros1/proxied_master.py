"""`rtron master` in the place of a test's own master."""

from copy import copy

from harness import wait_for

from rtron.guard.master_proxy.master_file import find_private_master
from rtron.planning.plan_file.writer import write_plan


def start(ros1, plan, *more):
    """Put the master proxy of the plan where the test's master was; return a view from behind it.

    Processes that the view starts find the proxy; its questions go to the master behind it.
    """
    ros1.master.kill()
    path = ros1.folder / "proxy.yaml"
    path.write_text(write_plan(plan))
    port = ros1.uri.rpartition(":")[2]
    ros1.master = ros1.rtron("master", "--plan", path, "--port", port, *more)
    wait_for(lambda: ros1.ask(ros1.uri, "getPid") is not None, what="the proxy")
    inside = copy(ros1)
    inside.uri = find_private_master(ros1.uri)
    assert inside.uri != ros1.uri
    return inside
