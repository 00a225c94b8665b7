"""Keep pydicom from warning and logging, because its texts quote attributes of the patient."""

from __future__ import annotations

import contextlib
import logging
import warnings
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextlib.contextmanager
def quiet_pydicom() -> Iterator[None]:
    """Switch off pydicom's checks of values, warnings and log meanwhile, for all threads."""
    import pydicom

    settings = pydicom.config.settings
    logger = logging.getLogger("pydicom")
    mode, level = settings.reading_validation_mode, logger.level
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        settings.reading_validation_mode = pydicom.config.IGNORE
        logger.setLevel(logging.CRITICAL + 1)
        try:
            yield
        finally:
            settings.reading_validation_mode = mode
            logger.setLevel(level)
