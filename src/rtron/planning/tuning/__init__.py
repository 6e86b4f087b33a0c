from rtron.planning.tuning.tuner import tune
from rtron.planning.tuning.written import tuned_yaml

__all__ = ["tune", "tuned_yaml"]
