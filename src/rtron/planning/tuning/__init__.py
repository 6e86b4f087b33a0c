from rtron.planning.tuning.tuner import tune_plan, tuned_yaml
