"""Where a command about many things works: here, in processes, or on a cluster."""

from typing import TYPE_CHECKING, Annotated

import typer

from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.executors import Executor

ProcessCount = Annotated[
    int | None,
    typer.Option(
        "--jobs", "-j", min=1, metavar="N", help="Work in N processes; no more than cores."
    ),
]
ClusterAddress = Annotated[
    str | None,
    typer.Option("--cluster", metavar="ADDRESS", help="Work on a Dask cluster that you trust."),
]


def chosen_executor(
    jobs: int | None, cluster: str | None, *, chunk: int, worth: bool
) -> "Executor":
    """Return what is asked for, of cores no more than there are.

    By default that is all of them if the work is worth it, else this process.

    `chunk` things go to a worker together. Raise InputError if both are asked for.
    """
    from rtron.executors import Cluster, Here, Processes  # noqa: PLC0415 - the guard starts without it
    from rtron.sources.static.common.scan_options import default_workers  # noqa: PLC0415 - the guard starts without it

    if cluster and jobs:
        help = "leave one of the two out: a cluster has its own workers"
        raise InputError("both --cluster and --jobs are given", help=help)
    if cluster:
        return Cluster(cluster, chunk)
    cores = default_workers()
    count = min(jobs or (cores if worth else 1), cores)
    return Processes(count, chunk) if count > 1 else Here()
