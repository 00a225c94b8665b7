"""The scalar of a volume from an array, as kernels read it, and from textures: time and error.

numba-cuda has no textures. Here they come from cuda-bindings, which it rests on, and from one line
of PTX. The filter of a texture has weights of nine bits, one of them before the point: it is wrong
by up to 1/256 of the difference between neighbours along each axis. Eight reads of a texture
without filter, and weights of our own, are as exact as an array.
"""

from contextlib import contextmanager

import numpy as np
from llvmlite import ir
from numba import cuda
from numba.cuda import types
from numba.cuda.extending import intrinsic

from vtkmcvr.kernels.grid import trilinear
from vtkmcvr.kernels.rng import start, uniform

f32, i32 = np.float32, np.int32
HALF = f32(0.5)
READ = "tex.3d.v4.f32.f32 {$0, $1, $2, $3}, [$4, {$5, $6, $7, $7}];"
# Paths, and lookups of each: in a row, a fraction of a voxel apart, as tentative collisions are
PATHS, LOOKUPS, STEP = 2**20, 256, f32(0.7)
THREADS, REPEATS = 128, 5
EDGE = 512
# By how much a filtered lookup may be off, in differences of neighbours: three axes
MOST_ERROR = 3 / 256


@intrinsic
def texture_at(typingctx, texture, x, y, z):
    """First channel of a 3D texture at (x, y, z), float32."""
    signature = types.float32(types.uint64, types.float32, types.float32, types.float32)

    def codegen(context, builder, signature, arguments):
        single, handle = ir.FloatType(), ir.IntType(64)
        four = ir.LiteralStructType([single] * 4)
        kind = ir.FunctionType(four, [handle, single, single, single])
        read = ir.InlineAsm(kind, READ, "=f,=f,=f,=f,l,f,f,f")
        return builder.extract_value(builder.call(read, arguments), 0)

    return signature, codegen


@cuda.jit(device=True)
def texel_mean(texture, p):
    """Scalar at index position p from eight texels, as `trilinear` has it."""
    a, b, c = f32(i32(p[0])), f32(i32(p[1])), f32(i32(p[2]))
    fx, fy, fz = p[0] - a, p[1] - b, p[2] - c
    x, y, z = a + HALF, b + HALF, c + HALF
    one = f32(1.0)
    c00 = texture_at(texture, x, y, z)
    c00 += (texture_at(texture, x + one, y, z) - c00) * fx
    c10 = texture_at(texture, x, y + one, z)
    c10 += (texture_at(texture, x + one, y + one, z) - c10) * fx
    c01 = texture_at(texture, x, y, z + one)
    c01 += (texture_at(texture, x + one, y, z + one) - c01) * fx
    c11 = texture_at(texture, x, y + one, z + one)
    c11 += (texture_at(texture, x + one, y + one, z + one) - c11) * fx
    low = c00 + (c10 - c00) * fy
    return low + (c01 + (c11 - c01) * fy - low) * fz


@cuda.jit(device=True)
def path_of(number, edge):
    """Where a path begins, and its steps in index coordinates; it stays inside."""
    rng = start(1, number, 0)
    rng, x = uniform(rng)
    rng, y = uniform(rng)
    rng, z = uniform(rng)
    rng, u = uniform(rng)
    rng, v = uniform(rng)
    room = f32(edge - 3) - STEP * f32(LOOKUPS)
    step = STEP * f32(0.577)
    p = f32(1.0) + x * room, f32(1.0) + y * room, f32(1.0) + z * room
    return p, (step * u, step * v, step)


@cuda.jit
def by_array(values, edge, out):
    """Sum of the scalars that a path meets, from an array."""
    path = cuda.grid(1)
    p, d = path_of(path, edge)
    total = f32(0.0)
    for _ in range(LOOKUPS):
        total += trilinear(values, p)
        p = p[0] + d[0], p[1] + d[1], p[2] + d[2]
    out[path] = total


@cuda.jit
def by_filter(texture, edge, out):
    """The same from a texture that is filtered by the device."""
    path = cuda.grid(1)
    p, d = path_of(path, edge)
    total = f32(0.0)
    for _ in range(LOOKUPS):
        total += texture_at(texture, p[0] + HALF, p[1] + HALF, p[2] + HALF)
        p = p[0] + d[0], p[1] + d[1], p[2] + d[2]
    out[path] = total


@cuda.jit
def by_texels(texture, edge, out):
    """The same from a texture that is not filtered."""
    path = cuda.grid(1)
    p, d = path_of(path, edge)
    total = f32(0.0)
    for _ in range(LOOKUPS):
        total += texel_mean(texture, p)
        p = p[0] + d[0], p[1] + d[1], p[2] + d[2]
    out[path] = total


def described(values, filtered):
    """Driver's descriptions of a 3D array, of the copy to it, and of a texture of it."""
    from cuda.bindings import driver

    depth, rows, columns = values.shape
    kinds = driver.CUarray_format
    array = driver.CUDA_ARRAY3D_DESCRIPTOR()
    array.Width, array.Height, array.Depth, array.NumChannels = columns, rows, depth, 1
    array.Format = {
        "f4": kinds.CU_AD_FORMAT_FLOAT, "i2": kinds.CU_AD_FORMAT_SIGNED_INT16,
        "u1": kinds.CU_AD_FORMAT_UNSIGNED_INT8,
    }[values.dtype.str[1:]]  # fmt: skip
    copy = driver.CUDA_MEMCPY3D()
    copy.srcMemoryType = driver.CUmemorytype.CU_MEMORYTYPE_HOST
    copy.srcHost, copy.srcPitch, copy.srcHeight = values.ctypes.data, values.strides[1], rows
    copy.dstMemoryType = driver.CUmemorytype.CU_MEMORYTYPE_ARRAY
    copy.WidthInBytes, copy.Height, copy.Depth = values.strides[1], rows, depth
    texture = driver.CUDA_TEXTURE_DESC()
    texture.addressMode = [driver.CUaddress_mode.CU_TR_ADDRESS_MODE_CLAMP] * 3
    modes = driver.CUfilter_mode
    texture.filterMode = (
        modes.CU_TR_FILTER_MODE_LINEAR if filtered else modes.CU_TR_FILTER_MODE_POINT
    )
    return array, copy, texture


@contextmanager
def texture_of(values, filtered):
    """Texture object of a volume; whole numbers are read as parts of their type's largest."""
    from cuda.bindings import driver

    array, copy, texture = described(values, filtered)
    copy.dstArray = held = _done(driver.cuArray3DCreate(array))
    _done(driver.cuMemcpy3D(copy))
    source = driver.CUDA_RESOURCE_DESC()
    source.resType = driver.CUresourcetype.CU_RESOURCE_TYPE_ARRAY
    source.res.array.hArray = held
    made = _done(driver.cuTexObjectCreate(source, texture, None))
    try:
        yield np.uint64(int(made))
    finally:
        _done(driver.cuTexObjectDestroy(made))
        _done(driver.cuArrayDestroy(held))


def _done(answer):
    status, *result = answer
    if int(status) != 0:
        raise RuntimeError(f"the driver says {status!r}")
    return result[0] if result else None


def volume(kind):
    """Noise whose neighbours differ by up to its whole range: the worst case of a filter."""
    random = np.random.default_rng(2)
    if np.dtype(kind).kind == "f":
        return random.random((EDGE,) * 3, np.float32)
    return random.integers(0, np.iinfo(kind).max, (EDGE,) * 3, kind, endpoint=True)


def timed(kernel, source):
    """Seconds of all lookups, the best of some runs, and the sums."""
    out = cuda.device_array(PATHS, np.float32)
    seconds = []
    for _ in range(REPEATS + 1):
        begin, end = cuda.event(), cuda.event()
        begin.record()
        kernel[PATHS // THREADS, THREADS](source, EDGE, out)
        end.record()
        end.synchronize()
        seconds.append(1e-3 * cuda.event_elapsed_time(begin, end))
    return min(seconds[1:]), out.copy_to_host() / LOOKUPS


def compared(kind):
    """One type of voxels."""
    values = volume(kind)
    scale = 1.0 if values.dtype.kind == "f" else float(np.iinfo(kind).max)
    seconds, sums = {}, {}
    seconds["array"], sums["array"] = timed(by_array, cuda.to_device(values))
    for name, kernel in (("filtered", by_filter), ("texels", by_texels)):
        with texture_of(values, name == "filtered") as texture:
            seconds[name], sums[name] = timed(kernel, texture)
            sums[name] *= scale
    error = {k: float(np.abs(v - sums["array"]).max()) / scale for k, v in sums.items()}
    return {
        "lookups_per_second": {k: PATHS * LOOKUPS / v for k, v in seconds.items()},
        "error_of_means": error,
        "passed": error["filtered"] < MOST_ERROR and error["texels"] < 1e-5,
    }


def lookups():
    """Array against textures, for floats, 16-bit numbers and bytes."""
    found = {np.dtype(kind).name: compared(kind) for kind in (np.float32, np.int16, np.uint8)}
    return {"voxels": found, "passed": all(case["passed"] for case in found.values())}
