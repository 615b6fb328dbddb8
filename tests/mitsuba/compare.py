"""Renders the pairs of pairs.py with Mica and with Mitsuba 3 and compares their pixels.

    compare.py MICA FOLDER [NAME...]

Prints, a pair: Mica's total over Mitsuba's, a channel, and the relative L2 of pixels beside its bound. Exit code 1 if a
total is off by more than 0.5%, or an L2 is above its bound. Then the layers of layers.py."""

import math
import pathlib
import subprocess
import sys

import mitsuba as mi
import numpy as np

from layers import compare_layer, layers, write_maps
from pairs import Pair, T, pairs

SIZE = 48
TOTAL = 5e-3  # largest relative difference of totals


def write_exr(path, pixels):
    mi.Bitmap(np.ascontiguousarray(pixels, dtype=np.float32)).write(str(path))


def write_inputs(folder):
    """A sky that is another in each direction, a normal map of soft bumps that is the same in none, and a mesh."""
    row, column = np.mgrid[0:256, 0:512]
    theta, phi = math.pi * (row + 0.5) / 256, 2 * math.pi * (column + 0.5) / 512
    sky = np.stack([1 + np.cos(theta), 1 + np.sin(theta) * np.cos(phi), 1 + np.sin(theta) * np.sin(phi)], axis=-1)
    write_exr(folder / "sky.exr", sky)
    row, column = np.mgrid[0:64, 0:64]
    u, v = 2 * math.pi * (column + 0.5) / 64, 2 * math.pi * (63.5 - row) / 64
    slope_u, slope_v = 0.25 * np.cos(u + v) + 0.1, 0.15 * np.cos(u + v) + 0.1 * np.sin(2 * v)
    normals = np.stack([-slope_u, -slope_v, np.ones_like(u)], axis=-1)
    normals = 0.5 + 0.5 * normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    write_exr(folder / "bumps.exr", normals)
    write_exr(folder / "bumps_rows.exr", normals[::-1])
    (folder / "quad.obj").write_text("v -1 -1 0\nv 1 -1 0.3\nv 1 1 0.6\nv -1 1 0.3\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                     "f 1/1 2/2 3/3 4/4\n")


def render_mica(program, folder, pair: Pair):
    path = folder / "pair.toml"
    # Nearest to a box filter, which is exact in Mitsuba; its Gaussian is a table of 31 values.
    path.write_text(f"[image]\nfilter = \"subpixels\"\nwidth = {SIZE}\nheight = {SIZE}\n{pair.image}"
                    f"[camera]\nposition = {pair.eye}\nlook_at = {pair.target}\nup = {pair.up}\nfov = {pair.fov}\n{pair.job}")
    done = subprocess.run([program, "render", path, "-o", folder / "pair.exr", "--quiet"], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{pair.name}: {done.stderr}")
    return np.array(mi.Bitmap(str(folder / "pair.exr")).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def render_mitsuba(pair: Pair):
    to_world = T().look_at(origin=pair.eye, target=pair.target, up=pair.up)
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    sensor = {"type": "perspective", "fov": pair.fov, "fov_axis": "y", "to_world": to_world, "film": film,
              "sampler": {"type": "stratified", "sample_count": pair.samples}}
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": pair.depth, "rr_depth": 64}, "sensor": sensor}
    return np.array(mi.render(mi.load_dict({**scene, **pair.scene})))[..., :3]


def compare(program, folder, pair: Pair):
    ours, theirs = render_mica(program, folder, pair).astype(float), render_mitsuba(pair).astype(float)
    totals = ours.sum(axis=(0, 1)) / theirs.sum(axis=(0, 1))
    l2 = np.linalg.norm(ours - theirs) / np.linalg.norm(theirs)
    good = bool(np.abs(totals - 1).max() <= TOTAL and l2 <= pair.l2)
    print(f"{'good' if good else 'BAD ':4}  {pair.name:44} {' '.join(f'{t:.4f}' for t in totals)}  {l2:.4f} of {pair.l2}",
          flush=True)
    return good


def main(program, folder, *names):
    folder = pathlib.Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    write_inputs(folder)
    write_maps(folder)

    def chosen_of(all):
        return [one for one in all if not names or any(name in one.name for name in names)]

    chosen = chosen_of(pairs(folder))
    print(f"pair {'':45} Mica's total over Mitsuba's  L2")
    bad = [pair.name for pair in chosen if not compare(program, folder, pair)]
    chosen_layers = chosen_of(layers())
    bad += [layer.name for layer in chosen_layers if not compare_layer(program, folder, layer)]
    print(f"{len(chosen)} pairs and {len(chosen_layers)} layers, {len(bad)} bad")
    return 1 if bad or not chosen + chosen_layers else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
