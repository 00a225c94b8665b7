"""Base of filters that turn one image into another."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline

from .dependencies import Dependencies
from .parameters import Parameter

logger = logging.getLogger("vtkmcvr")

UPDATE_EXTENT = vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT()
WHOLE_EXTENT = vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT()


class ImageFilter(VTKPythonAlgorithmBase):
    """vtkImageData -> vtkImageData; a subclass has `Parameter` attributes and the method `produce`.

    An exception in `produce` reaches the caller of Update() of this filter or of another one of
    this package downstream. A pull from elsewhere ends without data: an ErrorEvent, else a log
    message, says why.

    Parameters
    ----------
    **settings
        Parameters by name.

    Raises
    ------
    TypeError
        For a name that is no parameter.
    """

    def __init__(self, **settings: Any) -> None:
        super().__init__(1, "vtkImageData", 1, "vtkImageData")
        self._values: dict[str, Any] = {}
        self._dependencies = Dependencies(self)
        self._failure: BaseException | None = None
        self._caller_listens = False
        for name, value in settings.items():
            if not isinstance(getattr(type(self), name, None), Parameter):
                raise TypeError(f"{type(self).__name__} has no parameter {name!r}")
            setattr(self, name, value)

    def produce(self, image: vtkImageData) -> vtkImageData:
        """Return the output for an input image; implemented by subclasses."""
        raise NotImplementedError

    def parameter_changed(self, name: str) -> None:
        """Mark this filter as modified, now and when the parameter's VTK object is."""
        self._dependencies.watch(name, self._values[name])
        self.Modified()

    # Updates from Python

    def Update(self, *args: Any) -> Any:
        """Bring the output up to date, or raise what went wrong here or in a filter upstream."""
        chain = list(_chain(self))
        for algorithm in chain:
            algorithm._check_input()
            algorithm._dependencies.poll()
            algorithm._caller_listens, algorithm._failure = True, None
        try:
            result = super().Update(*args)
        finally:
            for algorithm in chain:
                algorithm._caller_listens = False
        for algorithm in chain:
            if algorithm._failure is not None:
                failure, algorithm._failure = algorithm._failure, None
                raise failure
        return result

    def UpdateInformation(self, *args: Any) -> Any:
        """Bring the announced extent up to date."""
        for algorithm in _chain(self):
            algorithm._dependencies.poll()
        return super().UpdateInformation(*args)

    # Requests of the pipeline

    def RequestUpdateExtent(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Ask for the whole input."""
        info = inputs[0].GetInformationObject(0)
        info.Set(UPDATE_EXTENT, info.Get(WHOLE_EXTENT), 6)
        return 1

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Produce the output; exceptions must not leave into C++."""
        output = vtkImageData.GetData(outputs, 0)
        try:
            output.ShallowCopy(self.produce(vtkImageData.GetData(inputs[0], 0)))
        except (Exception, KeyboardInterrupt) as failure:
            self._failure = failure
            output.Initialize()
            self._report(f"{type(failure).__name__}: {failure}")
            return 0
        return 1

    def _report(self, text: str) -> None:
        if self.HasObserver("ErrorEvent"):
            self.InvokeEvent("ErrorEvent", text)
        elif not self._caller_listens:
            logger.error("%s: %s", type(self).__name__, text)

    def _check_input(self) -> None:
        name = type(self).__name__
        if not self.GetNumberOfInputConnections(0):
            raise ValueError(
                f"{name} has no input: call SetInputConnection(source.GetOutputPort()) or "
                "SetInputDataObject(image)"
            )
        self.GetInputAlgorithm(0, 0).UpdateDataObject()
        data = self.GetInputDataObject(0, 0)
        if not isinstance(data, vtkImageData):
            given = "nothing" if data is None else data.GetClassName()
            raise TypeError(f"{name} takes a vtkImageData, its input gives {given}")


def _chain(algorithm: vtkAlgorithm) -> Iterator[ImageFilter]:
    """Yield the filters of this package upstream of `algorithm`, then itself."""
    for port in range(algorithm.GetNumberOfInputPorts()):
        for index in range(algorithm.GetNumberOfInputConnections(port)):
            yield from _chain(algorithm.GetInputAlgorithm(port, index))
    if isinstance(algorithm, ImageFilter):
        yield algorithm
