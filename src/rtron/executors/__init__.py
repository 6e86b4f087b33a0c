from rtron.executors.base import (
    ItemFailure,
    MapExecutor,
    SerialExecutor,
    ThreadExecutor,
    UnorderedExecutor,
)
from rtron.executors.dask_cluster import DaskExecutor
from rtron.executors.process_pool import ProcessExecutor

__all__ = [
    "DaskExecutor",
    "ItemFailure",
    "MapExecutor",
    "ProcessExecutor",
    "SerialExecutor",
    "ThreadExecutor",
    "UnorderedExecutor",
]
