"""The plan for a launch without its base, which is firmware, or starts apart, or was not read."""

from dataclasses import replace

from notation import graph_of

from rtron.vocabulary import SECOND, Supervision
from rtron.workflows.plan import propose
from rtron.workflows.scan import scan_graph

TOPIC, INPUT = "/cmd_vel", "/rtron/cmd_vel/flow1"
NODE, LAST_NODE = "/rtron/grcn_cmd_vel", "/rtron/msrcn"
REFUSED = "unapproved publisher /stranger under the public name"


def leaving(ros, type, *bystanders):
    """Return the plan of an app that commands a base unseen, and nodes that are taken for it."""
    readers = "".join(f"{node} own own\n    sub {TOPIC} {type}\n" for node in bystanders)
    graph = graph_of("app", f"/nav nav own\n    pub {TOPIC} {type}\n{readers}", ros=ros)
    waits = Supervision(stall_after=SECOND // 5)
    return replace(propose(scan_graph(graph)).plan, supervision=waits)
