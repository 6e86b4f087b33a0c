from rtron.executors.cluster import Cluster
from rtron.executors.executor import Executor, Failed
from rtron.executors.here import Here
from rtron.executors.processes import Processes

__all__ = ["Cluster", "Executor", "Failed", "Here", "Processes"]
