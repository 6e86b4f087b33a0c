"""Well-known nodes and plugins whose source is often absent, as models in YAML."""

from rtron.sources.models.controllers import controllers
from rtron.sources.models.evaluate import interface, plugin_interface
from rtron.sources.models.form import Model
from rtron.sources.models.models import LIBRARY2, Models, load_models
from rtron.sources.models.plugin_element import PluginElement

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
