"""Standardised uptake values of PET, after the vendor-neutral rules of the QIBA SUV profile."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .dicom_headers import read_dataset
from .dicom_tags import floats_of, items_of, text_of

if TYPE_CHECKING:
    from pathlib import Path

PHILIPS_SUV_FACTOR = (0x7053, 0x1000)
DAY = 86400.0
LONGEST_DELAY = 12 * 3600.0


def suv_factor(path: Path) -> tuple[float, str]:
    """Return what the values of a PET file are multiplied by to give SUV by body weight.

    SUV = activity concentration (Bq/ml) x body weight (g) / injected dose (Bq), the dose decayed
    to the time that the concentrations are corrected to.

    Returns
    -------
    factor : float
        0 where there is none.
    problem : str
        What the file lacks; empty where there is a factor. No attribute is quoted.
    """
    dataset, _ = read_dataset(path)
    if text_of(dataset, "Modality") != "PT":
        return 0.0, "a PET series"
    unit = text_of(dataset, "Units")
    if unit == "GML":
        return 1.0, ""
    if unit == "CNTS":
        factor = floats_of(dataset, PHILIPS_SUV_FACTOR, 1)  # type: ignore[arg-type]
        return (factor[0], "") if factor and factor[0] > 0 else (0.0, "values in Bq/ml")
    if unit != "BQML":
        return 0.0, "values in Bq/ml"
    return _from_activity(dataset)


def _from_activity(dataset: Any) -> tuple[float, str]:
    weight = floats_of(dataset, "PatientWeight", 1)
    tracer = next(iter(items_of(dataset, "RadiopharmaceuticalInformationSequence")), None)
    dose = floats_of(tracer, "RadionuclideTotalDose", 1)
    half_life = floats_of(tracer, "RadionuclideHalfLife", 1)
    if not weight or weight[0] <= 0:
        return 0.0, "the body weight, which the file does not give"
    if not dose or dose[0] <= 0 or not half_life or half_life[0] <= 0:
        return 0.0, "injected dose and half-life, which the file does not give"
    correction = text_of(dataset, "DecayCorrection")
    if correction == "ADMIN":
        delay: float | None = 0.0
    elif correction == "START":
        delay = _delay(dataset, tracer)
    else:
        return 0.0, "values corrected for decay to the scan's start or to the injection"
    if delay is None:
        return 0.0, "the times of injection and scan, which the file does not give"
    decayed = dose[0] * 2.0 ** (-delay / half_life[0])
    return weight[0] * 1000.0 / decayed, ""


def _delay(dataset: Any, tracer: Any) -> float | None:
    """Return the seconds from injection to the time that decay is corrected to."""
    injected = _time_of_day(text_of(tracer, "RadiopharmaceuticalStartDateTime")[8:]) or (
        _time_of_day(text_of(tracer, "RadiopharmaceuticalStartTime"))
    )
    started = _time_of_day(text_of(dataset, "SeriesTime"))
    acquired = _time_of_day(text_of(dataset, "AcquisitionTime"))
    # A series that was made anew has a later time than its acquisition.
    if started is None or (acquired is not None and acquired < started):
        started = acquired
    if injected is None or started is None:
        return None
    delay = (started - injected) % DAY
    return delay if delay <= LONGEST_DELAY else None


def _time_of_day(text: str) -> float | None:
    digits = text.split("+")[0].split("-")[0].replace(":", "")
    try:
        return int(digits[:2]) * 3600.0 + int(digits[2:4]) * 60.0 + float(digits[4:] or 0)
    except ValueError:
        return None
