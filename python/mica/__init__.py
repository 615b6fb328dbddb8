"""Mica: glint normal distribution functions in large batches on OpenCL devices, inside NumPy.

import mica

flakes = mica.NormalMap.generate("flakes", resolution=1024)
evaluator = mica.Evaluator(flakes, "auto", tolerance=0.01)
density = evaluator([0.5, 0.5], flakes.covariance(4), [[0.0, 0.0], [0.1, 0.0]], roughness=0.02)
picture = mica.Job.load("shell.toml").render()
"""

from mica import _mica
from mica._answers import Energy, Samples
from mica._device import devices
from mica._errors import DeviceError, Error, FileError, UsageError
from mica._evaluator import Evaluator
from mica._glints import GlintLayer, glints
from mica._grid import Grid
from mica._image import Image
from mica._job import Job
from mica._map import NormalMap
from mica._methods import methods
from mica._mica import DeviceInfo
from mica._pndf import pndf
from mica._tools import bench, selftest

__version__ = _mica.version()

__all__ = [
    "NormalMap",
    "Evaluator",
    "Grid",
    "pndf",
    "Energy",
    "Samples",
    "methods",
    "Job",
    "Image",
    "glints",
    "GlintLayer",
    "devices",
    "DeviceInfo",
    "bench",
    "selftest",
    "Error",
    "UsageError",
    "FileError",
    "DeviceError",
]
