"""How a volume that cannot be read is refused: one sentence that says what to do."""

from __future__ import annotations

import contextlib
import struct
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


class VolumeReadError(ValueError):
    """A volume could not be read; the message says what to do about it."""


def fail(source: Path, problem: str) -> NoReturn:
    """Raise the error for `source` as one sentence.

    Raises
    ------
    VolumeReadError
        Always.
    """
    raise VolumeReadError(f"{source}: {problem}.")


@contextlib.contextmanager
def header_errors(source: Path) -> Iterator[None]:
    """Turn what a header full of nonsense makes Python raise into the reader's error."""
    try:
        yield
    except VolumeReadError:
        raise
    except (ValueError, TypeError, LookupError, OverflowError, struct.error) as error:
        raise VolumeReadError(
            f"{source}: the header is damaged; copy or export the file again."
        ) from error
