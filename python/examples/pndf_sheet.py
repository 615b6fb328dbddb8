"""A sheet of P-NDFs: what pixels of three surfaces see of their normals, from near to far.

    python pndf_sheet.py [SHEET.png]

Needs matplotlib.
"""

import sys

import matplotlib

matplotlib.use("Agg")  # files, no windows
import matplotlib.pyplot as plt
import numpy as np

import mica

SURFACES = {
    "flakes": mica.NormalMap.generate("flakes", resolution=256),
    "brushed": mica.NormalMap.generate("brushed", resolution=256, rms_slope=0.2),
    "spectrum": mica.NormalMap.generate("spectrum", resolution=256, rms_slope=0.2),
}
SIGMAS = [1.0, 4.0, 16.0]  # of the footprints, texels


def main(path: str = "sheet.png") -> None:
    figure, rows = plt.subplots(len(SURFACES), len(SIGMAS), figsize=(6, 6), squeeze=False)
    for row, (name, surface) in zip(rows, SURFACES.items()):
        evaluator = mica.Evaluator(surface, tolerance=0.05)
        for axes, sigma in zip(row, SIGMAS):
            image = evaluator.pndf([[0.4, 0.6]], sigma, roughness=0.02, size=128)[0]
            # Brightness by the square root: peaks are a thousand times what is around them.
            axes.imshow(np.sqrt(image), cmap="magma", extent=(-1, 1, -1, 1))
            axes.set(title=f"{name}, {sigma:g} texels", xticks=[], yticks=[])
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    print(f"wrote {path}")


if __name__ == "__main__":
    main(*sys.argv[1:])
