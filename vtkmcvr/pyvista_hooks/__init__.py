"""What PyVista finds by entry points: `image.mcvr` and `plotter.mcvr`."""
