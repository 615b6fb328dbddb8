"""Speed against error of three methods on one surface, all against the exact one.

python speed_and_error.py [QUERIES]
"""

import sys
import time

import numpy as np

import mica


def queries(surface: mica.NormalMap, count: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Rows u v cuu cuv cvv s t roughness: footprints of 16 texels anywhere, half vectors near the centre."""
    random = np.random.default_rng(1)
    cov = surface.covariance(16)
    rows = np.empty((count, 8))
    rows[:, :2] = random.uniform(size=(count, 2))
    rows[:, 2:5] = cov[0, 0], cov[0, 1], cov[1, 1]
    rows[:, 5:7] = random.normal(scale=0.1, size=(count, 2))
    rows[:, 7] = 0.02
    return rows


def main(count: int = 100_000) -> None:
    surface = mica.NormalMap.generate("spectrum", resolution=512, rms_slope=0.1)
    rows = queries(surface, count)
    exact = mica.Evaluator(surface, "triangles").eval(rows)
    print(f"{'method':12} {'queries/s':>12} {'relative L2':>12} {'MiB':>6}")
    for name in ("triangles", "gaussians", "pyramid"):
        evaluator = mica.Evaluator(surface, name)
        evaluator.eval(rows[:1000])  # compiles
        started = time.perf_counter()
        densities = evaluator.eval(rows)
        seconds = time.perf_counter() - started
        error = np.linalg.norm(densities - exact) / np.linalg.norm(exact)
        print(f"{name:12} {count / seconds:12.3g} {error:12.2g} {evaluator.bytes / 2**20:6.1f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
