#!/usr/bin/env python3
"""What one core gives at most, for `cargo xtask measure optimize`: prints one JSON object.

Gflop/s in dense products of order 2000, Gbyte/s in sums of two long vectors: the best of five. Needs: pip install numpy
"""

import json
import time

import numpy as np


def best(work):
    work()
    times = []
    for _ in range(5):
        clock = time.perf_counter()
        work()
        times.append(time.perf_counter() - clock)
    return min(times)


ORDER, LENGTH = 2000, 20_000_000
a, b, c = np.random.rand(ORDER, ORDER), np.random.rand(ORDER, ORDER), np.empty((ORDER, ORDER))
x, y, z = np.ones(LENGTH), np.ones(LENGTH), np.zeros(LENGTH)
print(json.dumps({
    "gigaflops": 2e-9 * ORDER**3 / best(lambda: np.matmul(a, b, out=c)),
    "gigabytes": 24e-9 * LENGTH / best(lambda: np.add(x, y, out=z)),
}))
