"""What ParaView needs around the filters; the plugin itself is `plugin/vtkmcvr_plugin.py`."""
