"""Volumes of a vtkRenderer drawn by light transport, progressively, among VTK's own props.

Needs VTK and NumPy only: any render window will do.
"""

from .settings import LiveSettings
from .view import LiveView
from .window import LiveWindow

__all__ = ["LiveSettings", "LiveView", "LiveWindow"]
