"""A way through the guard into a cell, in which the receiver runs."""

import json
from dataclasses import replace
from functools import partial

from bench.common.pubsub import Route, StartRoute
from bench.common.testbed import Testbed, python
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan


def celled(way: Route, plan: Plan, opened: StartRoute) -> Route:
    """Return a way whose receiver is in the cell of a plan; `opened` starts the guard of it."""
    prefix = partial(cell_command, plan=plan)
    return replace(way, name="cell", start=opened, listen_prefix=prefix)


def cell_command(testbed: Testbed, plan: Plan) -> list[str]:
    """Return what runs a command in the plan's cell; as our own user, who finds this Python."""
    path, manifest = testbed.folder / "cell.yaml", testbed.folder / "cell.json"
    path.write_text(write_plan(plan), encoding="utf-8")
    manifest.write_text(json.dumps({"schema": "rtron.cell/1", "node": plan.cell[0]}))
    files = ("--plan", str(path), "--manifest", str(manifest))
    options = ("--allow-shared-user", "--log-level", "error")
    return [*python("rtron", "cell", *files, *options), "--"]
