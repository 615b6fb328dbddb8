"""P-NDF images to train on: a memory-mapped .npy of images, and beside it what each shows.

    python training_set.py FOLDER [IMAGES [SIZE]]

Writes images.npy (IMAGES, SIZE, SIZE) float32 and images.csv. Started again after it was stopped, it goes on where
it was; the files are the same, to the bit, as those of one run.
"""

import csv
import sys
from pathlib import Path

import numpy as np

import mica

BATCH = 250  # images that are drawn at a time
ROUGHNESS = (0.01, 0.08)
SIGMA = 4.0  # texels


def main(folder: str, count: int = 10_000, size: int = 64) -> None:
    surface = mica.NormalMap.generate("flakes", resolution=1024, seed=1)
    evaluator = mica.Evaluator(surface, "pyramid")
    random = np.random.default_rng(1)
    centers, roughness = random.uniform(size=(count, 2)), random.uniform(*ROUGHNESS, size=count)

    Path(folder).mkdir(parents=True, exist_ok=True)
    images_path, table_path = Path(folder, "images.npy"), Path(folder, "images.csv")
    done_path = Path(folder, "done.txt")
    done = int(done_path.read_text()) if done_path.exists() else 0
    mode = "r+" if done else "w+"
    images = np.lib.format.open_memmap(images_path, mode, dtype=np.float32, shape=None if done else (count, size, size))
    if images.shape != (count, size, size):
        sys.exit(
            f"{images_path}: found images of shape {images.shape}; expected {(count, size, size)}, or another folder"
        )
    for first in range(done, count, BATCH):
        some = slice(first, min(first + BATCH, count))
        evaluator.pndf(centers[some], SIGMA, roughness[some], size, out=images[some])
        images.flush()
        done_path.write_text(str(some.stop))
        print(f"{some.stop} of {count} images", file=sys.stderr)

    with open(table_path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["u", "v", "sigma_texels", "roughness"])
        table.writerows([u, v, SIGMA, r] for (u, v), r in zip(centers.tolist(), roughness.tolist()))


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
