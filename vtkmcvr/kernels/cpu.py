"""CPU launcher: one tile, serial, without the GIL."""

from .jit import launched
from .sample import take_sample


@launched
def render_tile(film, scene, row_0, row_1, column_0, column_1, goal, seed):
    """Bring every pixel of a tile up to its `goal` of samples; continues where the film is."""
    for row in range(row_0, row_1):
        for column in range(column_0, column_1):
            for sample in range(film.count[row, column], goal[row, column]):
                take_sample(film, scene, row, column, sample, seed)
