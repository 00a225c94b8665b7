"""The sources of the kernels, loaded a second time with decorators of one's own.

The second set of modules is what the first one is, line by line, and knows nothing of it: it can be
counted, rewritten or compiled differently while the first one renders.
"""

from __future__ import annotations

import ast
import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import itertools
import sys
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType

KERNELS = Path(__file__).parent.parent / "kernels"
DECORATORS = ("device", "exact", "glue", "kernel", "launched", "entry_point")

Decorators = Mapping[str, Callable[[Callable], Callable]]
Rewrite = Callable[[ast.Module], ast.Module]

# Numbers of the sets so far
_numbers = itertools.count()
_lock = threading.Lock()


def load_kernels(module: str, decorators: Decorators, rewrite: Rewrite | None = None) -> ModuleType:
    """Load a module of `vtkmcvr.kernels`, and what it imports, once more.

    Parameters
    ----------
    module : str
        Such as "cpu".
    decorators : mapping
        What takes the place of each of `DECORATORS` of `kernels.jit`. On-disk caches know no second
        set: functions of it must not get any.
    rewrite : callable, optional
        Changes the syntax tree of each module before it runs.
    """
    # Beside `kernels`, so that relative imports of the package around it find the same modules
    name = f"vtkmcvr._kernels_{next(_numbers)}"
    package = ModuleType(name)
    package.__path__ = [str(KERNELS)]
    finder = _Finder(name, rewrite)
    with _lock:
        sys.modules[name] = package
        sys.modules[f"{name}.jit"] = jit = ModuleType(f"{name}.jit")
        vars(jit).update(decorators)
        sys.meta_path.insert(0, finder)
        try:
            return importlib.import_module(f"{name}.{module}")
        finally:
            sys.meta_path.remove(finder)


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the modules of one second set."""

    def __init__(self, package: str, rewrite: Rewrite | None):
        self.prefix, self.rewrite = f"{package}.", rewrite

    def find_spec(self, fullname, path=None, target=None):
        if not fullname.startswith(self.prefix):
            return None
        file = KERNELS / f"{fullname.removeprefix(self.prefix)}.py"
        loader = _Loader(fullname, str(file), self.rewrite)
        return importlib.util.spec_from_file_location(fullname, file, loader=loader)


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads a module, rewritten."""

    def __init__(self, fullname: str, path: str, rewrite: Rewrite | None):
        super().__init__(fullname, path)
        self.rewrite = rewrite

    def get_code(self, fullname):
        if self.rewrite is None:
            return super().get_code(fullname)
        tree = ast.parse(self.get_data(self.path), self.path)
        return compile(ast.fix_missing_locations(self.rewrite(tree)), self.path, "exec")
