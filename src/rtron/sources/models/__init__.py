"""Well-known nodes and plugins whose source is often absent, as models in YAML."""

from rtron.sources.models.common.catalog import LIBRARY2, Models, load_models
from rtron.sources.models.common.evaluation import interface, plugin_interface
from rtron.sources.models.common.plugin_element import PluginElement
from rtron.sources.models.common.schema import Model
from rtron.sources.models.ros1.controllers import controllers

__all__ = [
    "LIBRARY2",
    "Model",
    "Models",
    "PluginElement",
    "controllers",
    "interface",
    "load_models",
    "plugin_interface",
]
