"""A picture with less noise beside the one that was measured."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import denoise
from .picture import Picture


@dataclass(frozen=True, eq=False, kw_only=True)
class DenoisedPicture(Picture):
    """Result of `Picture.denoised`: another radiance and alpha, the same film.

    Its error is not known: a denoiser's bias does not show in the film's variance. `nrms` is inf,
    and `standard_error` that of `measured`.

    Attributes
    ----------
    light : array (H, W, 3)
        Denoised radiance.
    coverage : array (H, W)
        Denoised alpha.
    how : dict
        Method, guides and what else decides the result.
    """

    light: NDArray[np.float32]
    coverage: NDArray[np.float32]
    how: dict[str, Any]

    @property
    def radiance(self) -> NDArray[np.float32]:
        """Denoised linear RGB, (H, W, 3), premultiplied by `alpha`."""
        return self.light

    @property
    def alpha(self) -> NDArray[np.float32]:
        """Denoised opacity of the volume, (H, W), [0, 1]."""
        return self.coverage

    @property
    def nrms(self) -> float:
        """Unknown: inf. See `measured.nrms` for the error before noise was reduced."""
        return float("inf")

    @property
    def denoiser(self) -> dict[str, Any]:
        """How noise was reduced, as plain JSON values."""
        return self.how

    @property
    def measured(self) -> Picture:
        """The picture as it was measured."""
        return Picture(**{field.name: getattr(self, field.name) for field in fields(Picture)})

    def refine(self, *args: Any, **options: Any) -> Picture:
        """Continue the measured picture and denoise that; see `Picture.refine`."""
        return self.measured.refine(*args, **options).denoised(self.how["method"])

    def arrays(self) -> dict[str, NDArray]:
        """All arrays by public name; "measured" is the radiance that "standard_error" is of."""
        return {**super().arrays(), "measured": self.measured.radiance}

    def facts(self) -> dict[str, Any]:
        """What was measured; the NRMS under a name that says it is of the measured film."""
        before = self.measured.nrms
        return {
            **super().facts(),
            "nrms_before_denoising": before if np.isfinite(before) else None,
        }


def denoised(picture: Picture, method: str) -> DenoisedPicture:
    """Picture with less noise; see `Picture.denoised`."""
    if method not in denoise.METHODS:
        raise ValueError(
            f"a denoising method is one of {', '.join(denoise.METHODS)}; got {method!r}"
        )
    if picture.denoiser is not None:
        raise ValueError(f"this picture is already denoised by {picture.denoiser['method']}")
    exposure = picture.display.exposure
    if method == "knn":
        how: dict[str, Any] = {"method": method, "exposure": exposure}
        light, coverage = denoise.knn(
            picture.radiance, picture.alpha, picture.standard_error, exposure,
            "auto" if picture.backend == "cuda" else "cpu",
        )  # fmt: skip
    else:
        how = {"method": method, "guides": list(picture.plan.scene.aovs)}
        light, coverage = denoise.oidn(
            picture.radiance, picture.alpha, picture.albedo, picture.normal
        )
    same = {field.name: getattr(picture, field.name) for field in fields(Picture)}
    return DenoisedPicture(**same, light=light, coverage=coverage, how=how)
