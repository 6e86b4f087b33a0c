"""`rtron instrument` and `rtron remaps`: the remaps that put the guard between the nodes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.commands.master import AllowSharedMemory, AllowSharedUser
from rtron.cli.support.options import Env, EnvAll, PlanOption, TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json
from rtron.workflows.launch_arguments import parse_assignments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.reports.plan.instrumentation import InstrumentedLaunch
    from rtron.workflows.instrument import InstrumentResult


def instrument(  # noqa: PLR0913 - one for each option
    launch: Annotated[
        str,
        typer.Argument(
            metavar="PKG/FILE",
            help="The launch file that starts the app, `pkg/file.launch` or a path; in ROS 2 one "
            "of .xml, .yaml or .py.",
        ),
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="ARG:=VALUE", help="The arguments for the launch file."),
    ] = None,
    *,
    plan: PlanOption,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="OUT.launch", help="The guarded launch file, of APP's kind."
        ),
    ],
    graph: Annotated[
        Path | None,
        typer.Option(
            metavar="GRAPH.json",
            help="The app's graph: check the plan against it now and at each start.",
        ),
    ] = None,
    keystore: Annotated[
        Path | None,
        typer.Option(
            metavar="KEYSTORE",
            help="Start each process in its enclave of this keystore, under Enforce (ROS 2).",
        ),
    ] = None,
    packages: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DIR",
            help="Search packages here first; can be repeated.  [default: the package of the "
            "launch file, or where ROS finds it, or the working folder]",
            show_default=False,
        ),
    ] = None,
    cell: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NODE",
            help="Run this node in a cell, which only the guard reaches; can be repeated.",
        ),
    ] = None,
    cell_user: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="The user of the node in its cell; see `rtron cell --user`."
        ),
    ] = "",
    allow_shared_user: AllowSharedUser = False,
    allow_shared_memory: AllowSharedMemory = False,
    env: Env = None,
    env_all: EnvAll = False,
    format: Annotated[
        TextOrJson, typer.Option(help="A report, or the same as JSON.")
    ] = TextOrJson.TEXT,
) -> Outcome:
    """Write a launch file that starts the app guarded.

    No node changes: the guarded launch file is the app's own, plus the guard,
    plus remaps that route each flow through the guard. Launch files that nodes
    start themselves are found in the source of the nodes; copies of their
    packages, which only those nodes see, hold the guarded ones.

    $ rtron instrument app.launch --plan rtron.yaml -o guarded.launch
    $ rtron instrument app.launch model:=waffle --plan rtron.yaml -o out.launch
    $ rtron instrument pkg/app.launch --plan rtron.yaml -o guarded.launch
    $ rtron instrument pkg/app.launch --packages src --plan rtron.yaml -o o.launch
    $ rtron instrument app.launch --plan rtron.yaml --graph g.json -o out.launch

    The plan names its ROS. For ROS 2, RTron rewrites XML and YAML launch files
    and wraps a Python one: the file stays as it is, and its nodes get their
    remaps when they start. RTron itself never runs it.

    $ rtron instrument app.launch.py --plan rtron.yaml -o guarded.launch.py
    $ rtron instrument app.launch.xml --plan rtron.yaml -o guarded.launch.xml

    A guarded XML or YAML file is valid for the given arguments and variables of
    the environment (--env). Started with others, it ends at once and names them;
    instrument again for those. A guarded Python launch file takes any arguments.

    With --keystore, which `rtron secure` writes, each process starts with its own
    identity, and sees the keys of no other one.

    $ rtron instrument a.launch.py --plan p.yaml --graph g.json --keystore k -o o

    With --cell, only the guard reaches the node: it has a network, a user and a
    /dev/shm of its own. The graph tells what else passes. Start the launch as
    root, or read what --allow-shared-user leaves open.

    $ rtron instrument app.launch --plan p.yaml --graph g.json --cell /base -o o

    Exit code: 0 every flow is guarded; 1 the plan guards nothing and no file is
    written, or a file is written, but some flow cannot be guarded and the plan
    does not accept that; 2 bad input.
    """
    from rtron.reports.plan.instrumentation import instrumentation_text, instrumentation_to_json
    from rtron.workflows.instrument import InstrumentRequest
    from rtron.workflows.instrument import instrument as run_instrument

    result = run_instrument(
        InstrumentRequest(
            launch=launch,
            arguments=parse_assignments(arguments or ()),
            folders=packages or (),
            env=env or (),
            env_all=env_all,
            plan=plan,
            output=output,
            graph=graph,
            keystore=keystore,
            cells=cell or (),
            cell_options=tuple(
                _cell_options(cell_user, user=allow_shared_user, memory=allow_shared_memory)
            ),
        )
    )
    guarded = _guarded_report(result)
    report = (
        as_json(instrumentation_to_json(guarded))
        if format is TextOrJson.JSON
        else instrumentation_text(guarded)
    )
    return Outcome(report, OK if guarded.is_closed and guarded.remaps else FINDINGS)


def _cell_options(name: str, *, user: bool, memory: bool) -> "Iterator[str]":
    """Yield the options of `rtron cell`, in whose script they are written."""
    if name:
        yield from ("--user", name)
    if user:
        yield "--allow-shared-user"
    if memory:
        yield "--allow-shared-memory"


def _guarded_report(result: "InstrumentResult") -> "InstrumentedLaunch":
    from rtron.reports.plan.instrumentation import InstrumentedLaunch, NodeRemap, UnenforceableNode

    written = result.launch
    if written is None:
        return InstrumentedLaunch(ros=result.ros, guards_nothing=True, left_out=result.left_out)
    return InstrumentedLaunch(
        ros=result.ros,
        launch=str(written.launch),
        files=tuple(map(str, (*written.files, *written.copies))),
        remaps=tuple(
            NodeRemap(node=r.node, topic=r.topic, written=r.written, target=r.target)
            for r in written.remaps
        ),
        unenforceable=tuple(
            UnenforceableNode(what=gap.what, why=gap.why, accepted=gap.accepted)
            for gap in written.unenforceable
        ),
        notes=written.notes,
    )


def remaps(
    node: Annotated[
        str, typer.Argument(metavar="[NODE]", help="Only this node's.", show_default=False)
    ] = "",
    *,
    plan: PlanOption,
    format: Annotated[TextOrJson, typer.Option(help="A report, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """List the remaps that put the guard between the nodes of a plan.

    `rtron instrument` writes them into a launch file. This lists them for nodes
    that start in another way: by hand, from a script, a service or a container.

    $ rtron remaps --plan rtron.yaml
    $ rtron remaps /nav --plan rtron.yaml
    $ rtron remaps --plan rtron.yaml --format json | jq '.nodes[].arguments'

    It reads the plan alone: whether a node has remaps of its own, it cannot see.
    `rtron verify --live` shows later whether all of them are in force.

    Exit code: 0 listed, 1 the plan enforces nothing, 2 bad plan or node.
    """
    from rtron.planning.instrument.common.remaps import planned_remaps
    from rtron.planning.plan_file.loader import read_plan
    from rtron.reports.plan.instrumentation import remaps_text, remaps_to_json

    read = read_plan(plan)
    listed = planned_remaps(read, node)
    report = (
        as_json(remaps_to_json(read.ros, listed))
        if format is TextOrJson.JSON
        else remaps_text(str(plan), read.ros, listed)
    )
    return Outcome(report, OK if listed else FINDINGS)
