"""A look and a view as numbers, which ParaView and plain VTK are both given."""

SIZE, SAMPLES, SEED = (160, 120), 8, 3
# Scalar, red, green, blue; scalar, opacity
COLOURS = [(-200.0, 0.75, 0.45, 0.35), (200.0, 0.9, 0.6, 0.4), (600.0, 1.0, 0.95, 0.85)]
OPACITIES = [(100.0, 0.0), (250.0, 0.3), (700.0, 0.9)]
# A point has no fractions, so that no language rounds them differently
CAMERA = {"position": (0.0, -650.0, 120.0), "up": (0.0, 0.0, 1.0), "angle": 30.0}
EXPOSURE = 0.5


def centre_of(bounds):
    """Middle of bounds, on whole numbers."""
    return [float(round((bounds[2 * k] + bounds[2 * k + 1]) / 2)) for k in range(3)]


def position_of(bounds):
    """Where the camera is."""
    return [c + p for c, p in zip(centre_of(bounds), CAMERA["position"], strict=True)]
