"""Files that are complete or not there: written beside their place, then moved into it."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


@contextmanager
def replacing(path: str | os.PathLike[str], ending: str) -> Iterator[Path]:
    """Give a name in the same folder to write to, and move what is there into place at the end.

    Parameters
    ----------
    path : path-like
        Where the file shall be; a file that is there stays until the new one is complete.
    ending : str
        What the name must end in, with its dot.

    Raises
    ------
    ValueError
        Where the name ends in something else.
    OSError
        Where the folder is missing, or anything went wrong while writing: one sentence.
    """
    path = Path(path)
    if path.suffix.lower() != ending:
        raise ValueError(f"the file name must end in {ending}, got {path.name}")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: there is no folder {path.parent}")
    temporary = path.with_name(f".{path.stem}-{secrets.token_hex(4)}{ending}")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise type(error)(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_vtk(writer: Any, path: Path) -> None:
    """Run a VTK writer, and raise OSError where VTK would print an error and go on."""
    messages: list[str] = []

    def note(_: object, __: str, message: str) -> None:
        messages.append(message.strip().rsplit("): ", 1)[-1])

    note.CallDataType = "string0"  # type: ignore[attr-defined]
    for speaker in (writer, writer.GetExecutive()):
        speaker.AddObserver("ErrorEvent", note)
    writer.SetFileName(str(path))
    writer.Write()
    if messages or writer.GetErrorCode():
        # The executive only says that a request failed
        reasons = [text for text in messages if not text.startswith("Algorithm ")]
        raise OSError(reasons[0].splitlines()[0] if reasons else "the disk may be full")
