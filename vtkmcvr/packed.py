"""What kernels see: the packed scene, the only interface between the library and its kernels.

Conventions. Arrays are [k, j, i], C order. Lengths are world units (mm for medical data). Positions
are relative to the volume's centre, in world orientation, except where the name says `index`.
Directions are unit vectors. Radiance is linear RGB (Rec. 709 primaries). Everything is float32 but
the camera, whose rays are computed in float64 until they enter the volume.

A field annotated `X | None` is an effect: None where the scene does not call for it, and kernels
are then compiled without it. Only `vtkmcvr.plan` builds these tuples, because a stray Python float
or a Fortran-ordered array would compile everything anew.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

F32 = np.float32
Vector = tuple[np.float32, np.float32, np.float32]
Vector64 = tuple[np.float64, np.float64, np.float64]
Matrix = tuple[Vector, Vector, Vector]
Matrix64 = tuple[Vector64, Vector64, Vector64]

# Consecutive samples of a pixel that share a set of Sobol points
BATCH = 16


# Voxels along each axis of a brick; unsigned, as indices of voxels are
BRICK = np.uintp(32)


class Bricks(NamedTuple):
    """Voxels in bricks, [k, j, i] like an array of the volume, without those that nobody reads.

    For devices without room for the volume: kernels of the CPU know arrays alone.
    """

    shape: tuple[np.int64, np.int64, np.int64]  # of the volume
    slot: NDArray[np.uint32]  # [k, j, i] of bricks: which one in `voxels`
    voxels: NDArray  # (n, BRICK, BRICK, BRICK)

    def __getitem__(self, place: Any) -> Any:
        """Voxel at (k, j, i), as kernels have it; a field by its number."""
        return voxel(self, place) if isinstance(place, tuple) else tuple.__getitem__(self, place)


def voxel(bricks: Any, place: Any) -> Any:
    """Voxel at (k, j, i); kernels compile it."""
    k, j, i = place
    slot = bricks.slot[k // BRICK, j // BRICK, i // BRICK]
    return bricks.voxels[slot, k % BRICK, j % BRICK, i % BRICK]


class Medium(NamedTuple):
    """The scalar field with its majorant grid."""

    values: NDArray  # [k, j, i], at least two points an axis; on a device perhaps Bricks
    majorant: NDArray[
        np.float32
    ]  # [k, j, i] of cells: bound of sigma_t; <= 0: empty, minus cells around
    cell_size: np.float32  # edge of a cell in index units
    cells_per_index: np.float32
    active_lo: Vector64  # index box outside of which the majorant is zero
    active_hi: Vector64
    index_from_world: Matrix  # directions: index units per world unit
    clip: Clip | None
    holes: Holes | None
    regions: Regions | None
    labels: NDArray | None  # [k, j, i] uint8 or uint16: row of the transfer tables


class GradientOpacity(NamedTuple):
    """Factor on the extinction by gradient magnitude, linear between entries."""

    factor: NDArray[np.float32]  # (n,), from gradient magnitude 0 on
    per_gradient: np.float32  # table entries per unit of the gradient magnitude
    world_from_index_gradient: Matrix


class Table2D(NamedTuple):
    """Extinction and colour by scalar and gradient magnitude, bilinear, clamped at the edges."""

    sigma_t: NDArray[np.float32]  # (gradients, scalars), 1/world unit
    colour: NDArray[np.float32]  # (gradients, scalars, 3)
    lowest: np.float32  # scalar of the first column
    per_scalar: np.float32
    lowest_gradient: np.float32
    per_gradient: np.float32
    world_from_index_gradient: Matrix


class ColourGrid(NamedTuple):
    """Colour of every point, which replaces that of the transfer function."""

    red: NDArray  # [k, j, i] like the values
    green: NDArray
    blue: NDArray
    scale: np.float32  # 1, or 1/255 for bytes


class Transfer(NamedTuple):
    """Transfer function tables over [lowest, highest scalar], linear between entries.

    The optional ones are there where their channel varies. With labels, each table holds the rows
    of all labels, one after another, and `first` is where that of a point starts.
    """

    sigma_t: NDArray[np.float32]  # (n,) extinction, 1/world unit; its maximum over all gradients
    colour: NDArray[np.float32]  # (n, 3) albedo and diffuse colour
    lowest: np.float32
    per_scalar: np.float32  # table entries per unit of the scalar
    gradient_opacity: GradientOpacity | None
    table_2d: Table2D | None
    colour_grid: ColourGrid | None
    emission: NDArray[np.float32] | None  # (n, 3) radiance of the absorbing part
    specular: NDArray[np.float32] | None  # (n, 3) instead of Gloss.specular
    exponent: NDArray[np.float32] | None  # (n,) instead of Gloss.exponent
    phase: NDArray[np.float32] | None  # (n,) instead of Phase.shape
    first: np.int32
    entries: np.int32  # of one row


class Panorama(NamedTuple):
    """The camera's directions are (longitude, latitude, unused) in this frame, in radians."""

    right: Vector64
    up: Vector64
    forward: Vector64


class SideBySide(NamedTuple):
    """The camera is the left eye's; the right eye's film lies on its right."""

    columns: np.int64  # of one eye
    origin: Vector64  # to be added for the right eye
    direction: Vector64


class Camera(NamedTuple):
    """Affine map from film to rays.

    At film position (x, y) in pixels, row 0 on top, the ray starts at
    origin + x origin_x + y origin_y and heads along direction + x direction_x + y direction_y
    (not normalised).
    """

    origin: Vector64
    origin_x: Vector64
    origin_y: Vector64
    direction: Vector64
    direction_x: Vector64
    direction_y: Vector64
    index_from_world: Matrix64
    index_of_centre: Vector64  # index position of the volume's centre
    filter: NDArray[np.float32]  # inverse distribution of the pixel filter, offsets in pixels
    panorama: Panorama | None
    side_by_side: SideBySide | None


class Lens(NamedTuple):
    """Thin lens: points of the focal plane are sharp."""

    radius: np.float32
    focus_distance: np.float32  # along the axis, to the focal plane
    right: Vector
    up: Vector
    axis: Vector
    corners: NDArray[np.float32] | None  # (n + 1, 2) of a polygonal aperture of radius 1; closed


class Sobol(NamedTuple):
    """Leading dimensions of a path are scrambled Sobol points instead of independent numbers."""

    key: np.uint64  # of a batch, plus an increment for each set of points drawn; 0 in the scene
    place: np.uint64  # of a sample in its batch; 0 in the scene
    sets: np.int64  # sets of points, in one or two dimensions, still to be drawn by a path


class Surface(NamedTuple):
    """Hybrid surface/volume scattering: where and how often a BRDF replaces the phase function."""

    mode: np.int32  # 0 hybrid by Eq. 1, 1 BRDF at every gradient, 2 above a threshold
    opacity_distance: np.float32  # of sigma_t in the opacity that P_brdf is proportional to; inf: 1
    world_from_index_gradient: Matrix
    per_gradient: np.float32  # 1 / largest gradient magnitude
    exponent_scale: np.float32  # 25 g^3, with g the gradient factor
    threshold: np.float32  # of the normalised gradient magnitude


class Gloss(NamedTuple):
    """Specular coat of surfaces: the glossy part of the Fresnel blend."""

    specular: Vector  # reflectance at normal incidence
    exponent: np.float32  # Blinn exponent; the GGX roughness is sqrt(2 / (exponent + 2))
    ggx: np.bool_  # GGX distribution of microfacets instead of Blinn's


class NormalMap(NamedTuple):
    """The film records the normal at the first collision, and so needs a gradient there."""

    world_from_index_gradient: Matrix


class Phase(NamedTuple):
    """Phase function other than isotropic."""

    kind: np.int32  # 0 Henyey-Greenstein, 1 Schlick, 2 Rayleigh, 3 cone
    shape: np.float32  # g; k; nothing; 1 - cosine of the cone's half angle


class Scattering(NamedTuple):
    """Multiple scattering."""

    most: np.int32  # scattering events of a path
    roulette: np.float32  # throughput below which Russian roulette may end the path


class Marching(NamedTuple):
    """Collisions by marching in equal steps, which is biased, instead of by tracking."""

    step: np.float32  # world units


class Shadows(NamedTuple):
    """Light is attenuated on its way to the scattering point."""

    reach: np.float32  # world units from the scattering point within which the medium attenuates


class RatioTracking(NamedTuple):
    """Transmittance by ratio tracking instead of a binary estimate."""

    roulette: np.float32  # transmittance below which Russian roulette ends the walk


class Gradient(NamedTuple):
    """Radiance that changes linearly with the angle of elevation."""

    up: Vector
    top: Vector
    bottom: Vector


class Ambient(NamedTuple):
    """Environment of constant radiance, or of three colours."""

    radiance: Vector  # everywhere, or at the horizon
    gradient: Gradient | None


class Environment(NamedTuple):
    """Environment map in latitude-longitude form, importance-sampled by radiance."""

    pixels: NDArray[np.float32]  # (rows, columns, 3), row 0 at the local +y pole
    row_cdf: NDArray[np.float32]  # (rows + 1,)
    column_cdf: NDArray[np.float32]  # (rows, columns + 1)
    local_from_world: Matrix
    world_from_local: Matrix


class Present(NamedTuple):
    """Marks that the scene has something; None where it has not."""

    number: np.int32


class Shapes(NamedTuple):
    """Which surfaces of area lights need code beyond that of a flat, distant rectangle."""

    near_rectangles: Present | None  # sampled by solid angle
    disks: Present | None
    spheres: Present | None
    cylinders: Present | None


class LightTextures(NamedTuple):
    """Factors of the radiance over the surfaces of area lights."""

    texels: NDArray[np.float32]  # (texels of all textures, 3)
    layout: NDArray[np.int32]  # (n, 3) first texel, rows, columns; rows 0: no texture


class AreaLights(NamedTuple):
    """Surfaces that emit. They block light, also with their dark side.

    Each one is a canonical surface in the frame of its unit axes u, v, w around its centre; see
    `kernels.shapes`.
    """

    kind: NDArray[np.int32]  # (n,) 0 rectangle, 1 disk, 2 sphere, 3 cylinder
    frame: NDArray[np.float32]  # (n, 4, 3) centre, u, v, w
    size: NDArray[np.float32]  # (n, 3)
    radiance: NDArray[np.float32]  # (n, 3)
    two_sided: NDArray[np.bool_]  # (n,)
    visible: NDArray[np.bool_]  # (n,) camera rays see it
    shapes: Shapes
    textures: LightTextures | None
    seen: Present | None  # some are visible


class DeltaLights(NamedTuple):
    """Directional and point lights, which no scattered ray can hit."""

    kind: NDArray[np.int32]  # (n,) 0 directional, 1 point
    position: NDArray[np.float32]  # (n, 3), point lights
    axis: NDArray[np.float32]  # (n, 3), direction of propagation (of the cone's axis)
    power: NDArray[np.float32]  # (n, 3), irradiance, or intensity in power per steradian
    attenuation: NDArray[np.float32]  # (n, 3), a + b r + c r^2 divides the intensity
    cone: NDArray[np.float32]  # (n, 2), cosine of the cone's half angle, exponent of its falloff


class LightTree(NamedTuple):
    """All lights (area, then delta, then the map) as a binary tree in depth-first order.

    The first child of node k is node k + 1. The tree chooses a light by estimated contribution, and
    finds the area lights that a ray meets.
    """

    bound: NDArray[np.float32]  # (m, 4) sphere around the cluster; radius < 0: no ray meets it
    cone: NDArray[np.float32]  # (m, 5) axis of emission, cosines of its spread and of its reach
    flux: NDArray[np.float32]  # (m,) irradiance, at unit distance where it decays
    within: NDArray[np.float32]  # (m,) irradiance in the volume, on average
    law: NDArray[np.int32]  # (m,) how flux becomes irradiance; see `kernels.light_tree`
    links: NDArray[np.int32]  # (m, 3) next node beyond the cluster, parent, light of a leaf or -1
    leaf: NDArray[np.int32]  # (n,) node of each light


class LightChoice(NamedTuple):
    """How directions toward the lights of the tree are drawn."""

    environment: np.int32  # index of the environment map, -1 without
    by_light: np.bool_  # sample directions by the lights
    by_scatter: np.bool_  # sample directions by the scattering function


class Clip(NamedTuple):
    """Planes and balls that bound what is kept: their intersection."""

    planes: NDArray[np.float32]  # (n, 4) a, b, c, e: a i + b j + c k + e is the height, world units
    normals: NDArray[np.float32]  # (n, 3) world, toward what is kept
    spheres: NDArray[np.float32]  # (m, 4) centre in index coordinates, radius in world units
    world_from_index: Matrix  # directions
    depth: np.float32  # world units behind a cut face within which a collision is on it


class Holes(NamedTuple):
    """Boxes and balls that are cut out."""

    planes: NDArray[np.float32]  # (6 n, 4) six faces a box; heights are positive inside
    normals: NDArray[np.float32]  # (6 n, 3) world, into the box
    spheres: NDArray[np.float32]  # (m, 4)
    world_from_index: Matrix
    depth: np.float32


class Regions(NamedTuple):
    """Cropping regions, where the kept ones are not just the middle one."""

    lower: Vector  # index coordinates
    upper: Vector
    flags: np.int32  # bit x + 3 y + 9 z: kept
    normals: Matrix  # world normals of the index axes, upward
    pitch: Vector  # world distance between index planes along each axis
    depth: np.float32


class Mesh(NamedTuple):
    """Opaque triangles in a bounding volume hierarchy, see `kernels.bvh`."""

    bounds: NDArray[np.float32]  # (nodes, 6) lower and upper corner
    first: NDArray[np.int32]  # (nodes,) first child, or first triangle of a leaf
    count: NDArray[np.int32]  # type: ignore[assignment]  # (nodes,) triangles of a leaf, else 0
    axis: NDArray[np.int32]  # (nodes,) along which the children are ordered
    parent: NDArray[np.int32]  # (nodes,) -1 for the root
    triangles: NDArray[np.float32]  # (m, 9) three corners
    normals: NDArray[np.float32]  # (m, 9) at the corners, or (0, 9): flat
    owner: NDArray[np.int32]  # (m,) index of the receiver


class Receivers(NamedTuple):
    """Opaque surfaces: shapes first, then meshes."""

    kind: NDArray[np.int32]  # (n,) of shapes: 0 plane, 1 box, 2 sphere
    local_from_world: NDArray[np.float32]  # (n, 3, 4) into the frame of the unit shape
    colour: NDArray[np.float32]  # (shapes and meshes, 3)
    specular: NDArray[np.float32]  # (shapes and meshes, 3)
    exponent: NDArray[np.float32]  # (shapes and meshes,)
    reach: np.float32  # extent of the finite ones around the volume's centre, world units


class Layer(NamedTuple):
    """Another volume in the same place; extinctions add."""

    medium: Medium
    transfer: Transfer
    surface: Surface | None
    gloss: Gloss | None
    index_from_world: Matrix64  # directions
    index_of_centre: Vector64  # index position, in this volume, of the first volume's centre


class Scene(NamedTuple):
    """Everything a sample of a pixel needs."""

    medium: Medium
    transfer: Transfer
    camera: Camera
    lens: Lens | None
    surface: Surface | None
    gloss: Gloss | None
    phase: Phase | None
    scattering: Scattering | None
    marching: Marching | None
    shadows: Shadows | None
    ratio: RatioTracking | None
    ambient: Ambient | None
    environment: Environment | None
    area_lights: AreaLights | None
    delta_lights: DeltaLights | None
    light_tree: LightTree | None
    choice: LightChoice | None
    environment_visible: np.bool_
    normal_map: NormalMap | None
    sobol: Sobol | None
    receivers: Receivers | None
    mesh: Mesh | None
    more: tuple[Layer, ...] | None
    backdrop: Backdrop | None


class Backdrop(NamedTuple):
    """Opaque things that another renderer draws: camera rays end there."""

    depth: NDArray[np.float32]  # (places, H, W) along the view axis
    colour: NDArray[np.uint8]  # (places, H, W, 4) as displayed
    offsets: NDArray[np.float64]  # (places, 2) position in the pixel
    axis: Vector64
    veils: Veils | None


class Veils(NamedTuple):
    """Translucent surfaces before a backdrop, nearest first."""

    first: NDArray[np.int64]  # (places H W + 1,) of each place, row and column
    depth: NDArray[np.float32]  # (n,) along the view axis
    colour: NDArray[np.uint8]  # (n, 4) as displayed, straight alpha


class Openings(NamedTuple):
    """Edges of a backdrop in each pixel, nearest first: what is behind is covered in part."""

    first: NDArray[np.int64]  # (rows columns + 1,)
    depth: NDArray[np.float32]  # (n,) along the view axis
    left: NDArray[np.float32]  # (n,) share of the pixel that is open behind it
    through: NDArray[np.float32]  # (n,) transmittance of the volume up to it, written by kernels
    next: NDArray[np.int64]  # (rows, columns) first edge that rays have not passed yet
    axis: Vector64


class Batches(NamedTuple):
    """Running moments of the means of batches of `BATCH` samples, [row, column], float64."""

    mean: NDArray[np.float64]  # (H, W, 3) mean of the batches that are complete
    m2: NDArray[np.float64]  # (H, W, 3) sum of squared deviations of their means


class Film(NamedTuple):
    """Running moments per pixel, [row, column], row 0 on top, float64."""

    count: NDArray[np.int64]  # type: ignore[assignment]  # (H, W) samples so far
    mean: NDArray[np.float64]  # (H, W, 3) radiance
    m2: NDArray[np.float64]  # (H, W, 3) sum of squared deviations
    hits: NDArray[np.int64]  # (H, W) samples that collided in the volume
    depth: NDArray[np.float64]  # (H, W) mean distance of the collisions
    rejected: NDArray[np.int64]  # (H, W) samples that were not finite, counted as zero
    violations: NDArray[np.int64]  # (H, W) those of them that met an extinction above its majorant
    # (H, W, 3) means over all samples of what the first collision met, 0 for a miss
    albedo: NDArray[np.float64] | None
    normal: NDArray[np.float64] | None  # world-space unit vectors toward the camera
    batches: Batches | None  # where samples of a batch depend on each other
    # (H, W, 4) mean of what backdrop and veils show, times what is left of it before the volume
    behind: NDArray[np.float64] | None
    cover: NDArray[np.float64] | None  # (H, W) mean of what veils leave of the hits


class FilmTotals(NamedTuple):
    """Sums over the pixels of a film; v is the variance of a mean, m the mean.

    While any pixel is unknown, the sums after that say nothing.
    """

    paths: float
    least: float  # fewest samples of a pixel
    bright: float  # means that are not 0
    unknown: float  # pixels whose variance is unknown
    noise: float  # v
    noise_squares: float  # square of the v of a pixel's three channels together
    squares: float  # m^2
    crossed: float  # m^2 v
    variance_squares: float  # v^2


class Screen(NamedTuple):
    """How a film is displayed; see `vtkmcvr.screen.Display`."""

    scale: np.float32  # of the radiance, before the curve
    film_like: np.bool_  # tone curve of Exposure Render; otherwise cut off at 1
    power: np.float32  # by which light is encoded; 0: sRGB
    window: NDArray[np.float32] | None  # weights of the film filter along an axis
    background: Vector | None  # linear display light


class Integrals(NamedTuple):
    """Integrals of a transfer function from its first table entry on, over entries.

    With labels there are the rows of all of them, one after another, as in `Transfer`.
    """

    sigma_t: NDArray[np.float32]  # (n,) extinction as light meets it, 1/world unit: at most `most`
    depth: NDArray[np.float64]  # (n,) integral of sigma_t
    whole: NDArray[np.float32]  # (n,) extinction as it is
    whole_depth: NDArray[np.float64]
    light: NDArray[np.float64]  # (n, 3) integral of sigma_t times colour
    colour: NDArray[np.float32]  # (n, 3) albedo
    clear: np.float32  # table position up to which there is no extinction in any row
    last: np.float32  # table position of the last entry of a row
    lowest: np.float32
    per_scalar: np.float32
    most: np.float32
    limited: np.bool_  # whether `most` changes anything


class Perspective(NamedTuple):
    """Rays meet in the eye: their obliqueness varies over the film."""

    eye_column: np.float32  # of the view axis
    eye_row: np.float32
    slope: np.float32  # world units sideways per world unit of depth, per pixel
    span: np.int64  # columns over which directions go evenly


class LayerBlock(NamedTuple):
    """Layers between planes across the view axis, as rays through pixels meet them.

    Index position of pixel (column, row) at depth z below the first plane:
    first + column first_x + row first_y + z (deep + column deep_x + row deep_y).
    """

    first: Vector
    first_x: Vector
    first_y: Vector
    deep: Vector
    deep_x: Vector
    deep_y: Vector
    thickness: np.float32  # of a layer, world units along the view axis
    before: np.float32  # from the eye to the first plane, world units along the view axis


class Layers(NamedTuple):
    """What a block of layers holds, [layer, row, column]."""

    depth: NDArray[np.float32]  # optical depth along the view axis, as light meets it
    whole: NDArray[np.float32]  # the same as it is; may be the array `depth` itself
    tinted: NDArray[np.float32] | None  # [colour, layer, row, column] `depth` for coloured light
    mixed: NDArray[np.float32] | None  # [colour, ...] depth times albedo, of several volumes
    seen: NDArray[np.float32]  # transmittance from the eye to the layer's front; 0: not seen
    front: NDArray[np.float32]  # table position of the scalar at front and back, where filled
    back: NDArray[np.float32]
    relief: NDArray[np.float32] | None  # optical depth that steps of the raster add to light's


class Lanes(NamedTuple):
    """Room for the look-ups of a row of a brick at all planes of a block, plane by plane.

    Arrays of several coordinates or corners hold them one after another.
    """

    values: NDArray  # (voxels,) the volume's own, flat
    t: NDArray[np.float32]  # (n,) depth behind the block's first plane, world units
    cell: NDArray[np.int32]  # (3 n,) voxel before the index position
    part: NDArray[np.float32]  # (3 n,) from there to the position
    corner: NDArray  # (8 n,) voxels around, of their own type
    entry: NDArray[np.float32]  # (n,) table position
    sigma_t: NDArray[np.float32]  # (n,)
    integral: NDArray[np.float64] | None  # (n,) None: extinction depends on more than the scalar
    depth: NDArray[np.float32]  # (n,) optical depth to the next plane


class Runs(NamedTuple):
    """Stretches of columns [start, end) of every row of every layer that hold anything."""

    flags: NDArray[np.uint8]  # [layer, row, segment] 0: nothing; 1: faint; 2
    count: NDArray[np.int32]  # type: ignore[assignment]  # [layer, row]
    start: NDArray[np.int32]  # [layer, row, run]
    end: NDArray[np.int32]
    before: NDArray[np.int64]  # [layer, rows + 1] runs before a row, of all that are listed
    listed: NDArray[np.int32]  # (n, 3) row, start and end of all runs, layer by layer
    slot: NDArray[np.int64]  # (n,) where each of them starts in compact arrays
    first: NDArray[np.int64]  # (layers + 1,) first of each layer


class Eye(NamedTuple):
    """What is left of view rays, [row, column] of the raster."""

    light: NDArray[np.float32]  # transmittance through the medium as light meets it
    whole: NDArray[np.float32]  # and as it is
    relief: NDArray[np.float32]
    reach: NDArray[np.int32]  # [row, 2] columns between which the relief may not be zero


class Cone(NamedTuple):
    """Cone of light, in the frame (columns, rows, toward the viewer)."""

    axis: Vector
    around_view: np.bool_  # the axis is every pixel's own view ray
    cosine: np.float32
    per_cosine: np.float32  # sharpness of its edge


class Beam(NamedTuple):
    """Rays toward light of one direction."""

    sideways_x: np.float32  # world units per unit of depth; perspective: times depth
    sideways_y: np.float32
    weight: np.float32


class Shade(NamedTuple):
    """Gradient shading of what the eye sees: Lambert and Blinn, light along the cone's axis."""

    surface: Surface
    toward_light: Vector  # world
    headlight: np.bool_  # the light is where the eye is, for each pixel
    right: Vector  # of the film, in the world
    down: Vector
    forward: Vector
    specular: Vector
    exponent: np.float32
    strength: np.float32  # 1: shaded; 0: normals only


class OcclusionFilm(NamedTuple):
    """Sums per pixel, [row, column]."""

    radiance: NDArray[np.float32]  # (h, w, 3)
    alpha: NDArray[np.float32]
    depth: NDArray[np.float32]  # distance from the eye times opacity
    share: NDArray[np.float32]  # opacity of the medium as light meets it
    albedo: NDArray[np.float32] | None  # (h, w, 3) times that opacity
    normal: NDArray[np.float32] | None  # (h, w, 3) world normal times that opacity


class Sheets(NamedTuple):
    """Two blocks of layers on a device, [which of them, ...]: one is filled, one is lit."""

    depth: NDArray[np.float32]  # [which, layer, row, column], as in `Layers`
    whole: NDArray[np.float32]
    tinted: NDArray[np.float32] | None  # [which, colour, layer, row, column]
    mixed: NDArray[np.float32] | None
    front: NDArray[np.float32]
    back: NDArray[np.float32]
    filled: NDArray[np.uint8]  # [which, layer, row, segment] 2: filled
    occupied: NDArray[np.uint8]  # [which, tile row, segment] 1: filled in any layer
    # Of the block that is lit
    seen: NDArray[np.float32]  # [layer, row, column]
    relief: NDArray[np.float32] | None
    visible: NDArray[np.uint8]  # [layer, row, segment] 0: not seen; 1: faint; 2


class Sweep(NamedTuple):
    """What is the same for all blocks of layers on a device."""

    perspective: Perspective | None
    edges: NDArray[np.int64]  # (4,) first column and row, end column and row of what the eye sees
    layers: np.int64  # how many there are in all
    bleeding: np.float32
    opaque: np.float32
    limited: np.bool_
    tiers: np.bool_
    skip: np.bool_


class BeamTable(NamedTuple):
    """Beams on a device: how they move, and what their rays have met."""

    cone: Cone
    table: NDArray[np.float32]  # (n, 3) sideways measures and weight
    order: NDArray[np.int32]  # (n,) in which they are summed
    few: np.int64  # how many of these light what is faint
    zooms: NDArray[np.float32]  # [layer] inverse of the depth, 1 in a parallel view
    places: NDArray[np.int32]  # (m, 2) rows, columns: see `trace_beams`
    first: NDArray[np.int32]  # (n, layers + 1) where a layer's places start
    middle: NDArray[np.int32]  # [beam, layer, 2] place half way through a layer
    # [beam, block, 4] last place before a block, and what is added to a pixel there to get where
    # its ray is kept, modulo rows and columns
    behind: NDArray[np.int32]
    buffers: NDArray[np.float32]  # [beam, colour, row, column] optical depth met before the block


class BlurTable(NamedTuple):
    """Light in one buffer per colour on a device, blurred between layers."""

    kappa: np.float32  # optical depth of the cone's mean path over that of its axis
    widths: NDArray[np.float32]  # [layer] window of the blur behind it, pixels; 0: none
    missing: NDArray[np.float32]  # [colour, row, column]
    other: NDArray[np.float32]


class PublishedTable(NamedTuple):
    """The occlusion buffer of the paper on a device."""

    points: NDArray[np.float32]  # [layer, sample, 2] offsets in rows and columns
    secants: NDArray[np.float32]  # [sample]
    exact: np.bool_
    missing: NDArray[np.float32]  # [before or behind, row, column], by turns


class SweptLight(NamedTuple):
    """How light goes through layers on a device: one of these."""

    beams: BeamTable | None
    blurred: BlurTable | None
    published: PublishedTable | None


class FilledVolume(NamedTuple):
    """One volume that fills layers on a device."""

    medium: Medium
    transfer: Transfer
    integrals: Integrals
    places: NDArray[np.float32]  # [block, 20] fields of its `LayerBlock`, one after another


class Phong(NamedTuple):
    """Light of a lamp at the eye, from the gradient alone, as VTK shades volumes."""

    ambient: np.float32
    diffuse: np.float32
    specular: np.float32
    power: np.float32


class Absorber(NamedTuple):
    """One volume of a picture by emission and absorption."""

    medium: Medium
    transfer: Transfer
    integrals: Integrals
    phong: Phong | None
    world_from_index_gradient: Matrix | None  # where gradients are looked up
    index_from_world: Matrix64  # directions
    index_of_centre: Vector64  # index position, in this volume, of the first volume's centre


class March(NamedTuple):
    """How rays are cut into steps."""

    per_voxel: np.float64  # steps while a ray moves by one along an index axis; 0: see `per_length`
    per_length: np.float64  # steps per world unit, else 0
    opaque: np.float32  # transmittance at which a ray ends
    skip: np.bool_  # leap over empty space
    rays: np.int64  # n of the n x n rays of a pixel


class RayFilm(NamedTuple):
    """Means over the rays of a pixel, [row, column]; colours and depth times opacity."""

    radiance: NDArray[np.float32]  # (H, W, 3)
    alpha: NDArray[np.float32]
    depth: NDArray[np.float32]  # distance from the eye
    albedo: NDArray[np.float32] | None  # (H, W, 3)
    normal: NDArray[np.float32] | None  # (H, W, 3) world normals toward the eye
