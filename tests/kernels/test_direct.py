import numpy as np
import pytest
from compiled import compiled

from vtkmcvr.kernels.direct import power_heuristic

f32 = np.float32
DENSITIES = [f32(x) for x in (0, 1e-38, 1e-30, 0.3, 1, 1e30, 3e38)]
weight = compiled(power_heuristic)


@pytest.mark.parametrize("p", DENSITIES)
@pytest.mark.parametrize("q", DENSITIES)
def test_weights_of_two_strategies_sum_to_one(p, q):
    # HC-33: f^2 overflows float32 from 2e19 on and underflows below 1e-23
    total = weight(p, q) + weight(q, p)
    assert total == (0 if p == q == 0 else pytest.approx(1, abs=1e-6))


@pytest.mark.parametrize("p", DENSITIES)
def test_a_certain_direction_has_all_the_weight(p):
    assert weight(f32(np.inf), p) == 1
    assert weight(p, f32(np.inf)) == 0
