"""File or folder -> volume."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

from vtkmcvr import checks
from vtkmcvr.readers import read_vtk, time_steps

from .base import WHOLE_EXTENT, logger
from .parameters import Parameter, one_of, optional

SDDP = vtkStreamingDemandDrivenPipeline
UPDATE_TIME = SDDP.UPDATE_TIME_STEP()


def _path(value: Any) -> str:
    if not isinstance(value, str | os.PathLike):
        raise TypeError(f"file_name must be a path, got {value!r}")
    return os.fspath(value)


def _ignored(value: Any) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


class VolumeReader(VTKPythonAlgorithmBase):
    """Reads a volume of any kind that `vtkmcvr.read` knows, with its time steps.

    No input. Output: vtkImageData in LPS and mm, with its direction matrix, the point array
    "values" and what the reader noticed as field data. The volume is read when its extent is
    asked for, because only then its type is known; the volume of one time step is kept.

    An exception reaches the caller of Update(). A pull from elsewhere ends without data: an
    ErrorEvent, else a log message, says why.

    Parameters
    ----------
    **settings
        Any parameter by name: `VolumeReader(file_name="ct/", series=4)`.

    Raises
    ------
    TypeError
        For a name that is no parameter.
    """

    file_name = Parameter("", _path, "File or folder.")
    series = Parameter(
        None, optional(one_of("series", str, int)), "DICOM series: number, UID or description."
    )
    time = Parameter(
        None, optional(lambda v: checks.whole("time", v, least=0)),
        "Volume of a 4-D source, from 0. None: the one of the time that downstream asks for.",
    )  # fmt: skip
    resample = Parameter(
        False, one_of("resample", bool), "Whether uneven or sheared stacks become a box."
    )
    ignore = Parameter((), _ignored, "What to leave out of a DICOM series, see `vtkmcvr.read`.")
    units = Parameter(None, optional(one_of("units", str)), "'suv' for PET, or None.")

    def __init__(self, **settings: Any) -> None:
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkImageData")
        self._values: dict[str, Any] = {}
        self._read: tuple[Any, vtkImageData] | None = None
        self._steps: tuple[Any, list[float]] | None = None
        self._failure: BaseException | None = None
        self._caller_listens = False
        for name, value in settings.items():
            if not isinstance(getattr(type(self), name, None), Parameter):
                raise TypeError(f"VolumeReader has no parameter {name!r}")
            setattr(self, name, value)

    def parameter_changed(self, name: str) -> None:
        """Mark this reader as modified."""
        self.Modified()

    @property
    def time_values(self) -> list[float]:
        """Time of each volume of the source: seconds where they are known."""
        key = (self.file_name, self.series, _stamp(self.file_name))
        if self._steps is None or self._steps[0] != key:
            self._steps = key, time_steps(self.file_name, series=self.series)
        return self._steps[1]

    # Updates from Python

    def Update(self, *args: Any) -> Any:
        """Bring the output up to date, or raise what went wrong."""
        return self._raising(super().Update, *args)

    def UpdateInformation(self, *args: Any) -> Any:
        """Bring extent and time steps up to date, or raise what went wrong."""
        return self._raising(super().UpdateInformation, *args)

    def _raising(self, update: Any, *args: Any) -> Any:
        self._failure, self._caller_listens = None, True
        try:
            result = update(*args)
        finally:
            self._caller_listens = False
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure
        return result

    # Requests of the pipeline

    def RequestInformation(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Announce extent, place, type and time steps."""
        info = outputs.GetInformationObject(0)
        try:
            image = self._image(self._index(info))
            times = self.time_values
        except (Exception, KeyboardInterrupt) as failure:
            return self._failed(failure)
        info.Set(WHOLE_EXTENT, image.GetExtent(), 6)
        info.Set(vtkDataObject.SPACING(), image.GetSpacing(), 3)
        info.Set(vtkDataObject.ORIGIN(), image.GetOrigin(), 3)
        matrix = image.GetDirectionMatrix()
        info.Set(vtkDataObject.DIRECTION(), matrix.GetData(), 9)
        scalars = image.GetPointData().GetScalars()
        if scalars is not None:
            vtkDataObject.SetPointDataActiveScalarInfo(
                info, scalars.GetDataType(), scalars.GetNumberOfComponents()
            )
        self._announce_times(info, times)
        return 1

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Hand out the volume; exceptions must not leave into C++."""
        output = vtkImageData.GetData(outputs, 0)
        info = outputs.GetInformationObject(0)
        try:
            index = self._index(info)
            output.ShallowCopy(self._image(index))
        except (Exception, KeyboardInterrupt) as failure:
            output.Initialize()
            return self._failed(failure)
        if len(self.time_values) > 1:
            output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), self.time_values[index])
        return 1

    def _announce_times(self, info: Any, times: list[float]) -> None:
        for key in (SDDP.TIME_STEPS(), SDDP.TIME_RANGE()):
            info.Remove(key)
        if len(times) > 1:
            info.Set(SDDP.TIME_STEPS(), times, len(times))
            info.Set(SDDP.TIME_RANGE(), (times[0], times[-1]), 2)

    def _index(self, info: Any) -> int:
        """Return the volume at or before the time that is asked for."""
        if self.time is not None:
            return self.time
        if not info.Has(UPDATE_TIME):
            return 0
        times = self.time_values
        wanted = info.Get(UPDATE_TIME)
        return max((k for k, time in enumerate(times) if time <= wanted + 1e-9), default=0)

    def _image(self, index: int) -> vtkImageData:
        if not self.file_name:
            raise ValueError("VolumeReader has no file_name: set a file or folder")
        key = (self.file_name, self.series, self.resample, self.ignore, self.units, index,
               _stamp(self.file_name))  # fmt: skip
        if self._read is None or self._read[0] != key:
            # Without a choice of the user, a source that needs one must say so.
            time = index if self.time is not None or index else None
            self._read = None
            image = read_vtk(
                self.file_name, series=self.series, time=time, resample=self.resample,
                ignore=self.ignore, units=self.units, progress=self._progress,
            )  # fmt: skip
            self._read = key, image
        return self._read[1]

    def _progress(self, fraction: float, text: str) -> None:
        self.SetProgressText(text)
        self.UpdateProgress(fraction)

    def _failed(self, failure: BaseException) -> int:
        self._failure = failure
        text = f"{type(failure).__name__}: {failure}"
        if self.HasObserver("ErrorEvent"):
            self.InvokeEvent("ErrorEvent", text)
        elif not self._caller_listens:
            logger.error("VolumeReader: %s", text)
        return 0


def _stamp(name: str) -> tuple[int, int]:
    """Return what changes when a file is written again, or a file of a folder comes or goes."""
    try:
        status = Path(name).stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
