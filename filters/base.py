"""Base of filters that turn one image into another."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any, NamedTuple

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline

from .dependencies import Dependencies
from .parameters import Parameter

logger = logging.getLogger("vtkmcvr")

UPDATE_EXTENT = vtkStreamingDemandDrivenPipeline.UPDATE_EXTENT()
WHOLE_EXTENT = vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT()


class Port(NamedTuple):
    """Input port of a filter."""

    kind: str
    optional: bool = False
    repeatable: bool = False


class ImageFilter(VTKPythonAlgorithmBase):
    """vtkImageData -> vtkImageData; a subclass has `Parameter` attributes and the method `produce`.

    A filter of other ports has its own `inputs`, `outputs` and `execute`.

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

    inputs: tuple[Port, ...] = (Port("vtkImageData"),)
    outputs: tuple[str, ...] = ("vtkImageData",)

    def __init__(self, **settings: Any) -> None:
        super().__init__(len(self.inputs), "vtkImageData", len(self.outputs), "vtkImageData")
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

    def execute(self, inputs: Any, outputs: Any) -> None:
        """Fill the outputs."""
        output = vtkImageData.GetData(outputs, 0)
        output.ShallowCopy(self.produce(vtkImageData.GetData(inputs[0], 0)))

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

    def FillInputPortInformation(self, port: int, info: Any) -> int:
        """Say what a port takes."""
        kind, optional, repeatable = self.inputs[port]
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), kind)
        info.Set(vtkAlgorithm.INPUT_IS_OPTIONAL(), int(optional))
        info.Set(vtkAlgorithm.INPUT_IS_REPEATABLE(), int(repeatable))
        return 1

    def FillOutputPortInformation(self, port: int, info: Any) -> int:
        """Say what a port gives."""
        info.Set(vtkDataObject.DATA_TYPE_NAME(), self.outputs[port])
        return 1

    def RequestUpdateExtent(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Ask for the whole of all inputs."""
        for vector in inputs:
            for index in range(vector.GetNumberOfInformationObjects()):
                info = vector.GetInformationObject(index)
                if info.Has(WHOLE_EXTENT):
                    info.Set(UPDATE_EXTENT, info.Get(WHOLE_EXTENT), 6)
        return 1

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Produce the outputs; exceptions must not leave into C++."""
        try:
            self.execute(inputs, outputs)
        except (Exception, KeyboardInterrupt) as failure:
            self._failure = failure
            for port in range(len(self.outputs)):
                vtkDataObject.GetData(outputs, port).Initialize()
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
        for port, wanted in enumerate(self.inputs):
            for index in range(self.GetNumberOfInputConnections(port)):
                self.GetInputAlgorithm(port, index).UpdateDataObject()
                data = self.GetInputDataObject(port, index)
                if data is None or not data.IsA(wanted.kind):
                    given = "nothing" if data is None else data.GetClassName()
                    where = f" {port}" if port else ""
                    raise TypeError(f"{name} takes a {wanted.kind}, its input{where} gives {given}")


def _chain(algorithm: vtkAlgorithm) -> Iterator[ImageFilter]:
    """Yield the filters of this package upstream of `algorithm`, then itself, each once."""
    seen: set[str] = set()

    def walk(one: Any) -> Iterator[ImageFilter]:
        if one.__this__ in seen:
            return
        seen.add(one.__this__)
        for port in range(one.GetNumberOfInputPorts()):
            for index in range(one.GetNumberOfInputConnections(port)):
                yield from walk(one.GetInputAlgorithm(port, index))
        if isinstance(one, ImageFilter):
            yield one

    yield from walk(algorithm)
