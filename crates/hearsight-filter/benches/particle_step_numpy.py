"""The step of particle_step.rs with numpy and filterpy (pip install numpy filterpy). Prints microseconds a step."""

import time

import numpy as np
from filterpy.monte_carlo import systematic_resample

COUNT, DIMENSIONS, SIGMA, REPEATS = 1000, 6, 0.5 * 0.04**0.5, 2000

random = np.random.default_rng(1)
np.random.seed(1)
states = random.standard_normal((COUNT, DIMENSIONS))
times = []
for _ in range(REPEATS):
    begin = time.perf_counter()
    states += SIGMA * random.standard_normal((COUNT, DIMENSIONS))
    log_weights = -2.0 * (states[:, :3] ** 2).sum(axis=1)
    weights = np.exp(log_weights - log_weights.max())
    weights /= weights.sum()
    states = states[systematic_resample(weights)]
    times.append(time.perf_counter() - begin)
times = np.array(times) * 1e6
print(f"median {np.median(times):.1f} us, fastest {times.min():.1f} us")
