"""The plan that is proposed for a launch without its base, which is firmware or starts apart."""

from dataclasses import replace

from notation import graph_of

from rtron.vocabulary import SECOND, Supervision
from rtron.workflows.plan import propose
from rtron.workflows.scan import scan_graph

TOPIC, INPUT = "/cmd_vel", "/rtron/cmd_vel/flow1"
NODE, LAST_NODE = "/rtron/grcn_cmd_vel", "/rtron/msrcn"
REFUSED = "unapproved publisher /stranger under the public name"


def leaving(ros, type):
    """Return the plan of an app whose only node commands a base that is not in its launch."""
    graph = graph_of("app", f"/nav nav own\n    pub {TOPIC} {type}\n", ros=ros)
    waits = Supervision(stall_after=SECOND // 5)
    return replace(propose(scan_graph(graph)).plan, supervision=waits)
