from rtron.planning.tune.tune import tune
from rtron.planning.tune.written import tuned_yaml

__all__ = ["tune", "tuned_yaml"]
