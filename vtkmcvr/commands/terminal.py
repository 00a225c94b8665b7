"""What a command says while it works, and how it is interrupted."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any


def write_json(path: str | None, facts: dict[str, Any]) -> None:
    """Write what was measured; nothing without a path."""
    if path is None:
        return
    from ..safe_files import replacing

    with replacing(path, Path(path).suffix.lower()) as temporary:
        temporary.write_text(json.dumps(facts, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def say_to(args: argparse.Namespace) -> Callable[[str], None]:
    """Printer that `--quiet` turns off."""
    return (lambda text: None) if args.quiet else print


class Interrupt:
    """Ctrl-C ends the render and keeps its picture; pressed again, it ends the program."""

    def __init__(self) -> None:
        self.pressed = False

    def is_set(self) -> bool:
        """Whether the user asked to end."""
        return self.pressed

    def __enter__(self) -> Interrupt:
        if threading.current_thread() is threading.main_thread():
            self.before = signal.signal(signal.SIGINT, self._press)
        return self

    def __exit__(self, *_: object) -> None:
        if hasattr(self, "before"):
            signal.signal(signal.SIGINT, self.before)

    def _press(self, *_: object) -> None:
        if self.pressed:
            raise KeyboardInterrupt
        self.pressed = True


class Bar:
    """Progress on a terminal: rich's bar, or a plain line without rich; nothing elsewhere."""

    def __init__(self, quiet: bool):
        self.on = not quiet and sys.stderr.isatty()
        self.rich: Any = None
        self.last = 0.0

    def __enter__(self) -> Bar:
        if self.on:
            try:
                from rich.console import Console
                from rich.progress import Progress
            except ImportError:
                return self
            self.rich = Progress(console=Console(stderr=True), transient=True)
            self.rich.start()
            self.task = self.rich.add_task("", total=1.0)
        return self

    def __exit__(self, *_: object) -> None:
        if self.rich is not None:
            self.rich.stop()
        elif self.on:
            print(file=sys.stderr)

    def __call__(self, progress: Any) -> None:
        """Show how far a render is."""
        self.show(progress.fraction, f"rendering, {progress.samples} samples")

    def show(self, fraction: float, text: str) -> None:
        """Show the share that is done, 0 to 1, and what is being done."""
        if self.rich is not None:
            self.rich.update(self.task, completed=fraction, description=text)
        elif self.on and time.monotonic() - self.last > 0.2:
            self.last = time.monotonic()
            print(f"\r{text[:60]:<60} {fraction:4.0%}", end="", file=sys.stderr, flush=True)
