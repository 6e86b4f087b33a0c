"""Python, 2 and 3, lowered to the intermediate representation; nothing of it is ever run."""

from rtron.sources.code.frontends.python.lowering import lower_python

__all__ = ["lower_python"]
