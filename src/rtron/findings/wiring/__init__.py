"""Faults in the wiring of an app: ends that do not meet, or that meet and do not fit."""
