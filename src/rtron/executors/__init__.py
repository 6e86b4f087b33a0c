from rtron.executors.base import Executor, Failed
from rtron.executors.dask_cluster import Cluster
from rtron.executors.here import Here
from rtron.executors.process_pool import Processes

__all__ = ["Cluster", "Executor", "Failed", "Here", "Processes"]
