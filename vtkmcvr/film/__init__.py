"""Films: running moments of pixels, their errors, filters and sums."""
