"""Bodies on a GPU as tensors of LibTorch, by DLPack: same numbers as on the host, and kept when the simulation is gone.

    python3 python/tests/on_gpu.py build/cuda-release/python/gonogo

scripts/gpu_check.sh runs it. It needs the extension module alone, so that machines without pandas and dimod can."""
import sys

import numpy as np
import torch

sys.path.insert(0, sys.argv[1])
import _core

FIELDS = ("position", "orientation", "velocity", "angular_velocity")


def falling_spheres():
    world = _core.World((4, 4, 4))
    world.add_sphere((2, 2, 3), radius=0.1)
    world.add_floor(0.0)
    simulation = _core.Simulation([world, world], gpu=True)
    simulation.set_gravity((1.0, 0, -9.81), world=1)
    simulation.step(200)
    return simulation


def check_values(simulation):
    every, second = simulation.bodies_on_device(), simulation.bodies_on_device(1)
    assert every.device.startswith("cuda:") and len(every) == 4, every.device
    for field in FIELDS:
        tensor = torch.from_dlpack(getattr(every, field))
        expected = np.concatenate([getattr(simulation.bodies(k), field) for k in range(2)])
        assert tensor.is_cuda, field
        assert tensor.cpu().numpy().dtype == expected.dtype and np.array_equal(tensor.cpu().numpy(), expected), field
        assert np.array_equal(torch.from_dlpack(getattr(second, field)).cpu().numpy(), expected[2:]), field


def check_lifetime(simulation):
    kept = torch.from_dlpack(simulation.bodies_on_device().position)
    height = float(simulation.bodies().position[0, 2])
    simulation.step(100)
    assert float(simulation.bodies().position[0, 2]) != height
    del simulation
    assert float(kept[0, 2]) == height


simulation = falling_spheres()
check_values(simulation)
check_lifetime(simulation)
print("bodies on the GPU as tensors: 2 checks passed")
