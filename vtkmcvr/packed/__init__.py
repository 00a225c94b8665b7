"""What kernels see: the packed scene, the only interface between the library and its kernels.

Conventions. Arrays are [k, j, i], C order. Lengths are world units (mm for medical data). Positions
are relative to the volume's centre, in world orientation, except where the name says `index`.
Directions are unit vectors. Radiance is linear RGB (Rec. 709 primaries). Everything is float32 but
the camera, whose rays are computed in float64 until they enter the volume.

A field annotated `X | None` is an effect: None where the scene does not call for it, and kernels
are then compiled without it. Only `vtkmcvr.plan` builds these tuples, because a stray Python float
or a Fortran-ordered array would compile everything anew.
"""

from .absorption import Absorber, March, Phong, RayFilm
from .backdrop import Backdrop, Openings, Veils
from .basics import BATCH, Matrix, Matrix64, Vector, Vector64
from .camera import Camera, Lens, Panorama, SideBySide, Sobol
from .film import Batches, Film, FilmTotals, Screen
from .geometry import Clip, Holes, Mesh, Receivers, Regions
from .layers import Eye, FilledVolume, Integrals, Lanes, LayerBlock, Layers, Perspective, Runs
from .lights import (
    MOST_TEXELS,
    Ambient,
    AreaLight,
    AreaLights,
    DeltaLights,
    Environment,
    LightChoice,
    LightNode,
    LightRows,
    LightSet,
    LightTextures,
    LightTree,
    Present,
    Shapes,
)
from .scattering import (
    Gloss,
    Gradient,
    Marching,
    NormalMap,
    Phase,
    RatioTracking,
    Scattering,
    Shadows,
    Surface,
)
from .scene import Layer, Scene
from .sweep import (
    Beam,
    BeamTable,
    BlurTable,
    Cone,
    OcclusionFilm,
    PublishedTable,
    Shade,
    Sheets,
    Sweep,
    SweptLight,
)
from .volume import BRICK, Bricks, ColourGrid, GradientOpacity, Medium, Table2D, Transfer, voxel

__all__ = [
    "BATCH",
    "BRICK",
    "MOST_TEXELS",
    "Absorber",
    "Ambient",
    "AreaLight",
    "AreaLights",
    "Backdrop",
    "Batches",
    "Beam",
    "BeamTable",
    "BlurTable",
    "Bricks",
    "Camera",
    "Clip",
    "ColourGrid",
    "Cone",
    "DeltaLights",
    "Environment",
    "Eye",
    "FilledVolume",
    "Film",
    "FilmTotals",
    "Gloss",
    "Gradient",
    "GradientOpacity",
    "Holes",
    "Integrals",
    "Lanes",
    "Layer",
    "LayerBlock",
    "Layers",
    "Lens",
    "LightChoice",
    "LightNode",
    "LightRows",
    "LightSet",
    "LightTextures",
    "LightTree",
    "March",
    "Marching",
    "Matrix",
    "Matrix64",
    "Medium",
    "Mesh",
    "NormalMap",
    "OcclusionFilm",
    "Openings",
    "Panorama",
    "Perspective",
    "Phase",
    "Phong",
    "Present",
    "PublishedTable",
    "RatioTracking",
    "RayFilm",
    "Receivers",
    "Regions",
    "Runs",
    "Scattering",
    "Scene",
    "Screen",
    "Shade",
    "Shadows",
    "Shapes",
    "Sheets",
    "SideBySide",
    "Sobol",
    "Surface",
    "Sweep",
    "SweptLight",
    "Table2D",
    "Transfer",
    "Vector",
    "Vector64",
    "Veils",
    "voxel",
]
