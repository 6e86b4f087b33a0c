from launch.core import normalize as normalize_to_list_of_substitutions
from launch.core import perform as perform_substitutions

__all__ = ["normalize_to_list_of_substitutions", "perform_substitutions"]
