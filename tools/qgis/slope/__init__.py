"""SLOPE in QGIS: the tools as a Processing provider. QGIS calls classFactory() when it loads the plugin."""


def classFactory(iface):
    """The plugin; iface is not used, and None in qgis_process."""
    from .provider import Plugin
    return Plugin()
