"""Several CUDA devices: the bits of one, and how much faster."""

from agreement import SINGLE, equal
from speed import SECONDS, planned, volumes

from vtkmcvr.gpu import launches
from vtkmcvr.gpu.device import CudaDevice
from vtkmcvr.gpu.several import SeveralDevices, opened
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.schedule import StopRules


def several_devices():
    """Film of all devices alike against that of one; of one alone, sharing with itself."""
    work = plan(SINGLE)
    group = opened()
    if group.count == 1:
        group = SeveralDevices([CudaDevice(0, 2, k) for k in range(2)])
    films = [
        launches.run(device, work.packed, empty_film(work), StopRules(64, None, None), 3)[0]
        for device in (CudaDevice(), group)
    ]
    return {"devices": group.name, "passed": equal(*films), "speed": speed()}


def speed():
    """Paths per second of all devices over those of one."""
    if opened().count == 1:
        return "one device alone"
    work = planned(next(iter(volumes().values())))
    rates = []
    for device in (CudaDevice(), opened()):
        rules = StopRules(None, SECONDS, None)
        film, _, seconds = launches.run(device, work.packed, empty_film(work), rules, 0)
        rates.append(int(film.count.sum()) / seconds)
    return rates[1] / rates[0]
