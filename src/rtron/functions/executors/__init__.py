from rtron.functions.executors.cluster import Cluster
from rtron.functions.executors.executor import Executor, Failed
from rtron.functions.executors.here import Here
from rtron.functions.executors.processes import Processes

__all__ = ["Cluster", "Executor", "Failed", "Here", "Processes"]
