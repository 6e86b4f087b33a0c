from rtron.planning.tuning.tuner import tune_plan, tuned_yaml

__all__ = ["tune_plan", "tuned_yaml"]
