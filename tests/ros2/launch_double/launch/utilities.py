from launch.core import perform as perform_substitutions

__all__ = ["perform_substitutions"]
