"""A layer of glints over a picture that NumPy drew: the G-buffer of a sphere, its camera and its lamp.

python glint_layer.py [SIZE]
"""

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

import mica

SCENE = """
surface.flakes = { generate = "spectrum", resolution = 512, rms_slope = 0.3, correlation = 8, seed = 1 }
material.paint = { surface = "flakes", repeat = [12, 6], roughness = 0.03, id = 1 }
"""
LAMP = np.array([4.0, -3.0, 4.0])


def draw(size: int) -> tuple[dict[str, Any], Any]:
    """A unit sphere from (0, -5, 0), seen along +y through the centres of pixels: channels of a G-buffer, and the picture."""
    pixel = 0.5 / size  # at unit distance
    across = pixel * (np.arange(size) + 0.5 - size / 2)
    ray = np.stack([*np.broadcast_arrays(across[None, :], 1.0, -across[:, None])], axis=-1)
    b, length2 = 5 * ray[..., 1], (ray**2).sum(axis=-1)  # |(0, -5, 0) + t ray| = 1
    root = b**2 - 24 * length2
    t = (b - np.sqrt(np.maximum(root, 0))) / length2
    normal = t[..., None] * ray - [0, 5, 0]
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    hit = (root > 0).astype(np.float32)
    x, y, z = np.moveaxis(normal, -1, 0)
    to_lamp = LAMP - normal
    picture = hit * 0.05 * np.maximum((to_lamp * normal).sum(axis=-1) / np.linalg.norm(to_lamp, axis=-1), 0)
    vectors = {"position": (x, y, z), "sh_normal": (x, y, z), "dp_du": (-y, x, 0 * x)}
    channels = {f"{name}.{axis}": part for name, parts in vectors.items() for axis, part in zip("XYZ", parts, strict=True)}
    channels["uv.U"], channels["uv.V"] = np.arctan2(x, -y) / (2 * math.pi) + 0.5, np.arcsin(z) / math.pi + 0.5
    return {**channels, "glint_id.X": hit}, picture


def camera(size: int) -> dict[str, Any]:
    """Blender's words: it looks along -z of its matrix, here along +y of the world."""
    lamp_at = [[1, 0, 0, LAMP[0]], [0, 1, 0, LAMP[1]], [0, 0, 1, LAMP[2]], [0, 0, 0, 1]]
    return {
        "resolution": [size, size],
        "camera": {
            "type": "PERSP",
            "angle_x": 2 * math.atan(0.25),
            "matrix_world": [[1, 0, 0, 0], [0, 0, -1, -5], [0, 1, 0, 0], [0, 0, 0, 1]],
        },
        "lamps": [{"name": "lamp", "type": "POINT", "energy": 300, "matrix_world": lamp_at}],
    }


def main(size: int = 256) -> None:
    channels, picture = draw(size)
    mica.Image(channels).write("gbuffer.exr")
    mica.Image(dict.fromkeys("RGB", picture)).write("picture.exr")
    Path("gbuffer.json").write_text(json.dumps(camera(size)))
    Path("scene.toml").write_text(SCENE)
    layer = mica.glints("gbuffer.exr", "scene.toml", "layer.exr", aovs=["D", "coverage"])
    for note in layer.notes:
        print(note)
    print(f"layer.exr is to be added to picture.exr: {layer.covered} pixels, {layer.queries} queries")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
