"""RTron finds what the functions of a robot app can do to each other, and guards it."""

__version__ = "0.1.0"
