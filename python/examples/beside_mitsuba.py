"""The same picture by Mica and by Mitsuba 3: a plate with a normal map under one lamp.

    python beside_mitsuba.py [PICTURES.png]

Needs mitsuba, from PyPI. docs/from-mitsuba.md says what becomes of a scene, key by key.
"""

import math
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import mica

SIZE, ROUGHNESS, SAMPLES = 64, 0.05, 1024
EYE, LAMP, INTENSITY = [0.0, -2.0, 3.0], [0.0, 2.5, 3.0], 30.0


def by_mica(path: Path) -> np.ndarray[Any, Any]:
    """(SIZE, SIZE) radiance. `normalmap` turns the frame and nothing else, as Mitsuba's BSDF of that name does."""
    job = mica.Job(
        {
            "image": {"width": SIZE, "height": SIZE, "subpixels": 4},
            "camera": {"position": EYE, "look_at": [0, 0, 0], "fov": 25},
            "surface": {"map": {"file": path, "encoding": "unorm"}},
            "material": {
                "metal": {
                    "surface": "map",
                    "ndf": "normalmap",
                    "roughness": ROUGHNESS,
                    "specular": {"color": [1, 1, 1]},
                }
            },
            "shape": [{"type": "plane", "size": 2, "material": "metal"}],
            "light": [{"type": "point", "position": LAMP, "intensity": [INTENSITY] * 3}],
        }
    )
    return job.render()["G"]


def by_mitsuba(path: Path) -> np.ndarray[Any, Any]:
    """The same of Mitsuba, by brute force."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    metal = {
        "type": "roughconductor",
        "distribution": "beckmann",
        "alpha": math.sqrt(2) * ROUGHNESS,
        "material": "none",
    }
    texture = {"type": "bitmap", "filename": str(path), "raw": True}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "sensor": {
                "type": "perspective",
                "fov": 25,
                "fov_axis": "y",
                "to_world": mi.ScalarTransform4f().look_at(origin=EYE, target=[0, 0, 0], up=[0, 0, 1]),
                "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}},
                "sampler": {"type": "stratified", "sample_count": SAMPLES},
            },
            "plate": {"type": "rectangle", "bsdf": {"type": "normalmap", "normalmap": texture, "nested": metal}},
            "lamp": {"type": "point", "position": LAMP, "intensity": INTENSITY},
        }
    )
    return np.array(mi.render(scene))[..., 1]


def main(path: str = "beside.png") -> None:
    surface = mica.NormalMap.generate("spectrum", resolution=64, rms_slope=0.2, correlation=8)
    s, t = np.moveaxis(surface.array, -1, 0)
    normals = {"R": s, "G": t, "B": np.sqrt(1 - s * s - t * t)}
    with tempfile.TemporaryDirectory() as folder:
        upright, turned = Path(folder, "map.exr"), Path(folder, "turned.exr")
        pixels = {name: 0.5 * number + 0.5 for name, number in normals.items()}
        mica.Image({name: pixel[::-1] for name, pixel in pixels.items()}).write(upright)
        mica.Image(pixels).write(turned)  # a rectangle of Mitsuba's has v = 0 at the file's first row
        ours, theirs = by_mica(upright), by_mitsuba(turned)
    blocks = [picture.reshape(8, SIZE // 8, 8, SIZE // 8).mean(axis=(1, 3)) for picture in (ours, theirs)]
    error = np.linalg.norm(blocks[0] - blocks[1]) / np.linalg.norm(blocks[1])
    print(f"mean radiance {ours.mean():.4g} and {theirs.mean():.4g}; blocks of 8 x 8 pixels differ by {error:.2%}")
    beside = mica.Image(dict.fromkeys("RGB", np.hstack([ours, theirs])))
    beside.write(path)
    print(f"wrote {path}")


if __name__ == "__main__":
    main(*sys.argv[1:])
