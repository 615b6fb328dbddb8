#!/usr/bin/env python3
"""Runs local_memory.cl on the first OpenCL device, by pyopencl and NumPy: prints how many of 4,096 groups have a wrong
sum, five times. Exit code: 1 when any has."""
import sys
from pathlib import Path

import numpy
import pyopencl

GROUPS = 4096

device = pyopencl.get_platforms()[0].get_devices()[0]
context = pyopencl.Context([device])
queue = pyopencl.CommandQueue(context)
program = pyopencl.Program(context, Path(__file__).with_suffix(".cl").read_text()).build()
result = pyopencl.Buffer(context, pyopencl.mem_flags.WRITE_ONLY, 4 * GROUPS)
sums = numpy.empty(GROUPS, numpy.int32)
wrong = []
for _ in range(5):
    program.sums(queue, (16 * GROUPS,), (16,), result)
    pyopencl.enqueue_copy(queue, sums, result)
    wrong.append(int((sums != 160000 * numpy.arange(GROUPS)).sum()))
print(f"{device.name.strip()}: wrong groups of {GROUPS}: {wrong}")
sys.exit(any(wrong))
