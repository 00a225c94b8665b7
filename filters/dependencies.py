"""VTK objects beside the input whose change makes an algorithm run again.

An algorithm written in Python cannot override GetMTime for the pipeline. So the objects are
observed, which a pull from downstream sees, and their modification times are asked before an update
from Python, which sees what sends no event.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from typing import Any

from vtkmodules.vtkCommonCore import vtkCommand, vtkObject
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from .members import members_of

MODIFIED = vtkCommand.ModifiedEvent


class Dependencies:
    """Objects that an algorithm depends on, and theirs.

    Parameters
    ----------
    algorithm : vtkAlgorithm
        Gets Modified(); only a weak reference is kept.
    """

    def __init__(self, algorithm: vtkAlgorithm) -> None:
        self._algorithm = weakref.ref(algorithm)
        self._roots: dict[str, tuple[vtkObject, ...]] = {}
        self._observed: list[tuple[vtkObject, int]] = []
        self._newest = 0
        self._components = 1
        self._quiet = False

    def watch(self, name: str, value: Any) -> None:
        """Depend on `value`, or on what it contains, instead of what had this name."""
        values = value if isinstance(value, tuple) else (value,)
        self._roots[name] = tuple(v for v in values if isinstance(v, vtkObject))
        self._observe()

    def components(self, count: int) -> None:
        """Depend on the functions of so many components; asking a property for more makes them."""
        if count > self._components:
            self._components = count
            self._observe()

    def poll(self) -> None:
        """Tell the algorithm if an object changed without an event."""
        if self._time() > self._newest:
            self._changed()

    def release(self) -> None:
        """Remove all observers."""
        for owner, tag in self._observed:
            owner.RemoveObserver(tag)
        self._observed = []

    def __del__(self) -> None:
        self.release()

    def _changed(self) -> None:
        algorithm = self._algorithm()
        if algorithm is None or self._quiet:
            return
        # The object may have got a new member
        self._observe()
        algorithm.Modified()

    def _observe(self) -> None:
        self.release()
        # Asking a property for its functions may create them, which is an event
        self._quiet = True
        try:
            owners = list(self._objects())
        finally:
            self._quiet = False
        self._newest = max((owner.GetMTime() for owner in owners), default=0)
        me = weakref.ref(self)

        def on_modified(*_: object) -> None:
            dependencies = me()
            if dependencies is not None:
                dependencies._changed()

        self._observed = [(o, o.AddObserver(MODIFIED, on_modified)) for o in owners]

    def _time(self) -> int:
        return max((owner.GetMTime() for owner in self._objects()), default=0)

    def _objects(self) -> Iterator[vtkObject]:
        for roots in self._roots.values():
            for root in roots:
                yield root
                yield from members_of(root, self._components)
