"""ParaView plugin: Monte Carlo Volume, Directional Occlusion, Medical Volume Reader.

Load this file with Tools > Manage Plugins, or put its folder on PV_PLUGIN_PATH. ParaView's Python
must find `vtkmcvr` with Numba; `docs/paraview.md` has the commands.
"""

from __future__ import annotations

from pathlib import Path

from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy

import vtkmcvr
from vtkmcvr.filters import DirectionalOcclusionFilter, MonteCarloFilter, VolumeReader
from vtkmcvr.filters.paraview import panels
from vtkmcvr.filters.paraview.picture import ViewPicture
from vtkmcvr.occlusion import Occlusion

paraview_plugin_name = "vtkmcvr"
paraview_plugin_version = vtkmcvr.__version__


@smproxy.filter(name="MonteCarloVolume", label="Monte Carlo Volume")
@smproperty.xml(panels.MONTE_CARLO)
class MonteCarloVolume(ViewPicture):
    """Light transport through the volume."""

    technique = MonteCarloFilter

    def SetSamples(self, samples: int) -> None:
        """Set the samples per pixel; more of them go on with the picture."""
        self.change(samples=samples)

    def SetSeconds(self, seconds: float) -> None:
        """Set the time to render; 0: no limit."""
        self.change(seconds=seconds or None)

    def SetSeed(self, seed: int) -> None:
        """Set the seed of the random numbers."""
        self.change(seed=seed)

    def SetMultipleScattering(self, on: int) -> None:
        """Set whether light scatters many times in the volume."""
        self.change(scattering="multiple" if on else "single")


@smproxy.filter(name="DirectionalOcclusionVolume", label="Directional Occlusion")
@smproperty.xml(panels.OCCLUSION)
class DirectionalOcclusionVolume(ViewPicture):
    """Shading by a cone of light from the viewer."""

    technique = DirectionalOcclusionFilter

    def SetHalfAngle(self, degrees: float) -> None:
        """Set the half angle of the cone."""
        self.change(occlusion=Occlusion(half_angle=degrees))


@smproxy.reader(
    name="MedicalVolumeReader", label="Medical Volume Reader",
    extensions="dcm nrrd nhdr nii nii.gz mha mhd", file_description="Medical volumes (vtkmcvr)",
)  # fmt: skip
@smproperty.xml(panels.READER)
class MedicalVolumeReader(VolumeReader):
    """DICOM, NRRD, NIfTI and MetaImage, with their true place in the world."""

    @smproperty.stringvector(name="FileName")
    @smdomain.filelist()
    @smhint.filechooser(
        extensions="dcm nrrd nhdr nii nii.gz mha mhd", file_description="Medical volumes"
    )
    def SetFileName(self, name: str) -> None:
        """Set the file; one of a DICOM series stands for its folder."""
        path = Path("" if name in (None, "None") else name)
        alone = path.suffix.lower() != ".dcm"
        self.file_name = (str(path) if alone else str(path.parent)) if path.name else ""

    def SetSeries(self, series: str) -> None:
        """Set the DICOM series; empty: the one of most slices."""
        self.series = series or None

    def SetStandardisedUptake(self, on: int) -> None:
        """Set whether PET is read as standardised uptake value."""
        self.units = "suv" if on else None

    def SetResample(self, on: int) -> None:
        """Set whether uneven or sheared stacks become a box."""
        self.resample = bool(on)

    @smproperty.doublevector(
        name="TimestepValues", information_only="1", si_class="vtkSITimeStepsProperty"
    )
    def GetTimestepValues(self) -> list[float] | None:
        """Times of a series of volumes."""
        times = self.time_values if self.file_name else []
        return times if len(times) > 1 else None
