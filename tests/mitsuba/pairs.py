"""Pairs of small scenes that should look alike, for compare.py: a job of Mica, and a scene of Mitsuba 3, which shares no
code with it.

Axes are Mica's, z up, in both. Mitsuba masks by the product of two of Smith's G1, Mica by the height-correlated G2:
roughness is small, and views are steep, where the two would differ. Bounds of the L2 are those of edges and highlights,
which the two filter in different ways, and of Mitsuba's noise."""

from dataclasses import dataclass, field

import mitsuba as mi

mi.set_variant("scalar_rgb")
T = mi.ScalarTransform4f

FLAT = '[surface.flat]\ngenerate = "spectrum"\nresolution = 16\nrms_slope = 0\n'
CHALK = 'surface = "flat"\nspecular = { ior = 1 }\ndiffuse = [0.7, 0.4, 0.2]\n'
ETA, K = [0.14, 0.38, 1.44], [3.98, 2.38, 1.6]
GOLD = f"specular = {{ eta = {ETA}, k = {K} }}\n"


@dataclass
class Pair:
    """`job` lacks camera and size; `scene` is Mitsuba's dictionary without sensor and integrator."""

    name: str
    job: str
    scene: dict
    l2: float  # largest relative L2 of pixels
    eye: list = field(default_factory=lambda: [1.0, -3.0, 2.2])
    target: list = field(default_factory=lambda: [0.1, 0.0, 0.2])
    up: list = field(default_factory=lambda: [0.0, 0.0, 1.0])
    fov: float = 34.0
    samples: int = 64
    depth: int = 2  # Mitsuba counts the edge from the light, too
    image: str = ""  # further keys of [image]


def rgb(values):
    return {"type": "rgb", "value": values}


def diffuse(values=(0.7, 0.4, 0.2)):
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(list(values))}}


def gold(alpha, distribution="beckmann"):
    u, v = alpha if isinstance(alpha, tuple) else (alpha, alpha)
    return {"type": "twosided", "bsdf": {"type": "roughconductor", "distribution": distribution, "alpha_u": u, "alpha_v": v,
                                         "eta": rgb(ETA), "k": rgb(K)}}


def plane(bsdf, size=6.0):
    return {"type": "rectangle", "to_world": T().scale([size / 2, size / 2, 1]), "bsdf": bsdf}


def sphere(bsdf, center=(0.0, 0.0, 0.6), radius=0.6):
    return {"type": "sphere", "center": list(center), "radius": radius, "bsdf": bsdf}


def job(material, shapes, lights, surfaces=FLAT):
    return f"{surfaces}[material.m]\n{material}{shapes}{lights}"


PLANE = '[[shape]]\ntype = "plane"\nmaterial = "m"\nsize = 6\n'
SPHERE = '[[shape]]\ntype = "sphere"\nmaterial = "m"\ncenter = [0, 0, 0.6]\nradius = 0.6\n'

LIGHTS = {
    "point": ('[[light]]\ntype = "point"\nposition = [1.2, -1.0, 2.5]\nintensity = [20, 30, 40]\n',
              {"type": "point", "position": [1.2, -1.0, 2.5], "intensity": rgb([20, 30, 40])}),
    "sun": ('[[light]]\ntype = "directional"\ndirection = [-0.5, 0.7, -1]\nirradiance = [3, 2, 1]\n',
            {"type": "directional", "direction": [-0.5, 0.7, -1.0], "irradiance": rgb([3, 2, 1])}),
    "furnace": ('[[light]]\ntype = "furnace"\nradiance = [0.5, 1, 2]\n',
                {"type": "constant", "radiance": rgb([0.5, 1, 2])}),
    "disk": ('[[light]]\ntype = "disk"\nposition = [0.3, 0.2, 1.6]\ndirection = [0, 0, -1]\nradius = 0.5\n'
             f"intensity = {[3.14159265 * 0.25 * c for c in (4, 5, 6)]}\n",
             {"type": "disk", "to_world": T().translate([0.3, 0.2, 1.6]).rotate([1, 0, 0], 180).scale(0.5),
              "emitter": {"type": "area", "radiance": rgb([4, 5, 6])}}),
    "ball": ('[[light]]\ntype = "sphere"\nposition = [0.3, 0.2, 1.6]\nradius = 0.3\n'
             f"intensity = {[3.14159265 * 0.09 * c for c in (4, 5, 6)]}\n",
             {"type": "sphere", "center": [0.3, 0.2, 1.6], "radius": 0.3,
              "emitter": {"type": "area", "radiance": rgb([4, 5, 6])}}),
}
# Lamps with an extent are seen in Mitsuba and not in Mica: these views look past them.
LOW = {"eye": [0.5, -1.6, 1.0], "target": [0.3, 0.1, 0.0], "fov": 30.0}
# About the point of the plane that mirrors the point light.
MIRROR = {"target": [1.09, -2.06, 0.0], "fov": 22.0}


def environment(path):
    return (f'[[light]]\ntype = "environment"\nimage = "{path}"\nrotation = 180\n',
            {"type": "envmap", "filename": path, "to_world": T().rotate([1, 0, 0], 90)})


def pairs(folder):
    """All of them. `folder` has sky.exr, bumps.exr (a normal map), bumps_rows.exr (its rows turned over), and quad.obj."""
    found = []

    def add(name, material, bsdf, light, l2, shape="plane", **more):
        ours, theirs = light
        shapes, shaped = (PLANE, plane(bsdf)) if shape == "plane" else (SPHERE, sphere(bsdf))
        found.append(Pair(name, job(material, shapes, ours), {"shape": shaped, "light": theirs}, l2, **more))

    for light in ("point", "sun", "furnace"):
        for shape in ("plane", "sphere"):
            add(f"chalk {shape}, {light}", CHALK, diffuse(), LIGHTS[light], 0.03 if shape == "plane" else 0.015, shape,
                image="samples = 64\n")
    for light in ("disk", "ball"):
        add(f"chalk plane, {light}", CHALK, diffuse(), LIGHTS[light], 0.005, **LOW)

    # One lobe about the geometric normal: of a flat map, and of glints that cannot be told from each other.
    for light in ("point", "sun"):
        for alpha in (0.05, 0.15):
            smooth = f'surface = "flat"\nndf = "normalmap"\nroughness = {alpha / 2 ** 0.5}\n' + GOLD
            add(f"gold sphere, alpha {alpha}, {light}", smooth, gold(alpha), LIGHTS[light], 0.01, "sphere",
                image="subpixels = 8\n", samples=400)
    for distribution in ("beckmann", "ggx"):
        glints = f'ndf = "grid"\ndensity = 1e12\nmicroroughness = 1e-3\ndistribution = "{distribution}"\n' + GOLD
        for alpha in ((0.15, 0.15), (0.2, 0.05), (0.05, 0.2)):
            add(f"gold plane, {distribution} {alpha[0]} {alpha[1]}, point", glints + f"alpha = {list(alpha)}\n",
                gold(alpha, distribution), LIGHTS["point"], 0.01, **MIRROR)
    narrow = 'surface = "flat"\nroughness = 0.0353553390593\n' + GOLD
    for ndf in ("triangles", "gaussians", "smooth"):
        add(f"gold plane, {ndf}, point", f'ndf = "{ndf}"\n' + narrow, gold(0.05), LIGHTS["point"], 0.01, **MIRROR)

    sky = environment(f"{folder}/sky.exr")
    add("chalk sphere, environment", CHALK, diffuse(), sky, 0.02, "sphere", image="samples = 64\n", samples=256)
    add("gold sphere, environment", 'ndf = "normalmap"\nroughness = 0.0707\nsurface = "flat"\n' + GOLD, gold(0.1), sky, 0.02,
        "sphere", image="samples = 64\n", samples=256)
    found.append(Pair("sky alone", job(CHALK, SPHERE.replace("0, 0, 0.6", "0, 0, -50"), sky[0]), {"light": sky[1]}, 0.005,
                      eye=[0, 0, 0], target=[1, 0.4, 0.3], fov=70.0, depth=1))

    # A camera that is rolled, and a plane of which the eye sees the edges.
    add("rolled camera", CHALK, diffuse(), LIGHTS["sun"], 0.03, up=[0.5, 0.2, 0.8], fov=75.0, eye=[2.5, -4.0, 4.0])
    bounces = job(CHALK, PLANE + SPHERE, LIGHTS["sun"][0])
    found.append(Pair("chalk sphere on a plane, two bounces", bounces,
                      {"shape": plane(diffuse()), "sphere": sphere(diffuse()), "light": LIGHTS["sun"][1]}, 0.03,
                      depth=3, image="samples = 32\nmax_bounces = 2\n"))

    mesh = '[[shape]]\ntype = "mesh"\nmaterial = "m"\nfile = "{}/quad.obj"\n'.format(folder)
    found.append(Pair("chalk mesh, point", job(CHALK, mesh, LIGHTS["point"][0]),
                      {"shape": {"type": "obj", "filename": f"{folder}/quad.obj", "bsdf": diffuse()},
                       "light": LIGHTS["point"][1]}, 0.03))

    # Classic normal mapping on both sides; Mitsuba's bitmaps stand on their heads on a rectangle.
    mapped = {"type": "twosided", "bsdf": {
        "type": "normalmap", "normalmap": {"type": "bitmap", "filename": f"{folder}/bumps_rows.exr", "raw": True},
        "bsdf": {"type": "roughconductor", "distribution": "beckmann", "alpha": 0.2, "eta": rgb(ETA), "k": rgb(K)}}}
    surface = f'[surface.flat]\nfile = "{folder}/bumps.exr"\nencoding = "unorm"\n'
    for light in ("point", "sun"):
        found.append(Pair(f"gold normal map, {light}",
                          job('surface = "flat"\nndf = "normalmap"\nroughness = 0.141421\n' + GOLD, PLANE,
                              LIGHTS[light][0], surface),
                          {"shape": plane(mapped), "light": LIGHTS[light][1]}, 0.01))
    return found
