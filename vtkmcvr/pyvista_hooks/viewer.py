"""A window that shows one volume in a look, refined while nothing moves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from ..live.settings import TECHNIQUES
from ..phases import Isotropic
from ..pictures.display import srgb_encode
from ..vtk_bridge.camera import vtk_camera_of
from ..vtk_bridge.look import property_of_transfer
from .convert import image_of_volume

if TYPE_CHECKING:
    from ..presets import Dressed
    from ..scene import Scene

# Steps of a colour function between two nodes: VTK's interpolates what the display shall show
COLOURS = 16


class Viewer:
    """One volume by light transport, and keys that change how it is seen.

    Parameters
    ----------
    dressed : Dressed
        Volume of one scalar a voxel, opacity, colours, shading, mask, exposure, camera, and the
        size of the window; its studio follows the camera.
    output : str or Path
        Where the key k writes the picture.
    **settings
        Of `vtkmcvr.live.LiveSettings`.

    Attributes
    ----------
    limits : tuple of str
        What of the look VTK's volume property cannot say, and the window therefore leaves out.

    Raises
    ------
    ValueError
        For colours by voxel and for label maps.
    """

    def __init__(self, dressed: Dressed, output: str | Path, **settings: Any) -> None:
        scene = dressed.scene
        if scene.volume.colours is not None or scene.labels is not None:
            raise ValueError(
                "the window shows volumes of one scalar a voxel, no colours and no label maps: "
                "make pictures of those, by vtkmcvr.render or `vtkmcvr render`"
            )
        self.plotter = cast(Any, pv.Plotter(window_size=list(scene.size), title="vtkmcvr"))
        self.output = Path(output)
        self._chart: Any = None
        self._clipped = False
        self.volume = _volume(scene)
        self.plotter.add_actor(self.volume, reset_camera=False, render=False, pickable=False)
        self.plotter.set_background("black")
        self.plotter.camera.DeepCopy(vtk_camera_of(scene.camera))
        self.plotter.renderer.ResetCameraClippingRange()
        usual: dict[str, Any] = {
            "lighting": dressed.studio, "exposure": dressed.exposure,
            "scattering": scene.scattering,
        }  # fmt: skip
        if scene.surface is not None:
            usual["gradient_factor"] = scene.surface.gradient_factor
        self.limits = _limits(scene)
        self.plotter.mcvr.enable(**(usual | settings))
        for key, (act, _) in self.keys.items():
            self.plotter.add_key_event(key, act)

    @property
    def keys(self) -> dict[str, tuple[Any, str]]:
        """What each key does, and in words."""
        return {
            "t": (self.next_technique, "next technique: Monte Carlo, occlusion, as VTK"),
            "o": (self.edit_opacity, "opacity editor: drag its points"),
            "c": (self.clip, "clip plane: drag it"),
            "l": (self.add_lamp, "a lamp to drag"),
            "k": (self.keep, f"keep the picture so far: {self.output}"),
        }

    def show(self) -> None:
        """Open the window; returns when it is closed. Off screen, the picture is finished."""
        self.plotter.show(auto_close=False)

    def close(self) -> None:
        """Let go of the window."""
        self.plotter.close()

    # What keys do

    def next_technique(self) -> None:
        """Change between light transport, occlusion, and emission and absorption."""
        now = TECHNIQUES.index(self.plotter.mcvr.settings.technique)
        self.plotter.mcvr.enable(technique=TECHNIQUES[(now + 1) % len(TECHNIQUES)])
        self.plotter.render()

    def edit_opacity(self) -> None:
        """Show the opacity editor, or take it away."""
        if self._chart is None:
            self._chart = self.plotter.mcvr.add_opacity_editor(self.volume)
        else:
            self.plotter.set_chart_interaction(False)
            self.plotter.remove_chart(self._chart)
            self._chart = None
        self.plotter.render()

    def clip(self) -> None:
        """Show a plane that cuts the volume, or take it away."""
        mapper = self.volume.GetMapper()
        if self._clipped:
            self.plotter.clear_plane_widgets()
            mapper.RemoveAllClippingPlanes()
        else:
            self.plotter.add_volume_clip_plane(self.volume, interaction_event="always")
        self._clipped = not self._clipped
        self.plotter.render()

    def add_lamp(self) -> None:
        """Add a lamp; with the first one the studio goes out."""
        if self.plotter.mcvr.settings.lighting != "scene":
            # Lights of what VTK draws
            self.plotter.remove_all_lights()
            self.plotter.mcvr.enable(lighting="scene")
        self.plotter.mcvr.add_light_widget()
        self.plotter.render()

    def keep(self) -> None:
        """Write the picture as it is."""
        self.plotter.mcvr.picture.save(self.output)


def _volume(scene: Scene) -> pv.Volume:
    mapper: Any = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetInputData(image_of_volume(scene.volume))
    if scene.mask is not None:
        kept = replace(scene.volume, values=np.where(scene.mask, np.uint8(255), np.uint8(0)))
        mapper.SetMaskInput(image_of_volume(kept))
        mapper.SetMaskTypeToBinary()
    own = property_of_transfer(scene.transfer, scene.surface)
    own.SetColor(_as_displayed(own.GetRGBTransferFunction()))
    volume = pv.Volume()
    volume.SetMapper(mapper)
    volume.SetProperty(own)
    return volume


def _limits(scene: Scene) -> tuple[str, ...]:
    absent = {
        "emission": scene.transfer.emission is not None,
        "the phase function": not isinstance(scene.phase, Isotropic),
    }
    return tuple(
        f"the window leaves out {what} of this look; `vtkmcvr render` has it"
        for what, there in absent.items()
        if there
    )


def _as_displayed(function: vtkColorTransferFunction) -> vtkColorTransferFunction:
    """Colours of reflectances in linear light -> as plotters have them."""
    nodes = np.empty((function.GetSize(), 6))
    for index in range(len(nodes)):
        function.GetNodeValue(index, nodes[index])
    steps = np.linspace(0, len(nodes) - 1, max(1, COLOURS * (len(nodes) - 1)) + 1)
    shown = vtkColorTransferFunction()
    for x in np.interp(steps, np.arange(len(nodes)), nodes[:, 0]):
        shown.AddRGBPoint(x, *srgb_encode(np.array(function.GetColor(x))))
    return shown
