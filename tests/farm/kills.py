#!/usr/bin/env python3
"""Kills `mica` at random moments, and looks at what it leaves.

    kills.py MICA WORK [COUNT [SEED]]

Renders pictures, sequences and shards, evaluates shards of a table, joins them and compiles kernels, each with SIGKILL,
SIGTERM or SIGINT after a random time; then runs the same once more with --skip-finished, undisturbed. It must succeed,
its files must be those of a run that nobody disturbed, byte by byte, and no temporary file may be left. Before that no
file of the disturbed run may be another one than a whole one: names appear with all of their bytes or not at all.
Compiling takes seconds, and is killed only in runs of 100 and more. Exit code: 0 when all of it holds.
"""
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

JOB = """image = { width = 16, height = 12, subpixels = 2 }
frames = { range = [0, 3] }
camera = { position = [0, -3, 1], keys = [{ frame = 0 }, { frame = 5, position = [1, -3, 1] }] }
surface.bumps = { generate = "spectrum", resolution = 32 }
material.gold = { surface = "bumps", roughness = 0.05 }
shape = [{ type = "sphere", material = "gold" }]
light = [{ type = "point", position = [-2, -2, 3], intensity = [30, 30, 30] }]
audit = { samples = 10 }
"""
PICTURES = {".exr", ".png", ".npy"}


def queries(count):
    """A .npy file of rows u v cuu cuv cvv s t."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count}, 7), }}"
    header += " " * (63 - (10 + len(header)) % 64) + "\n"
    rows = (struct.pack("<7d", 0.37 * n, 0.21 * n, 1e-3, 1e-4, 1e-3, 0.1, 0.05) for n in range(count))
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + b"".join(rows)


class Kills:
    def __init__(self, mica, work, count, seed):
        self.mica, self.work, self.random = mica, Path(work), random.Random(seed)
        self.whole = self.work / "whole"
        shutil.rmtree(self.work, ignore_errors=True)
        self.whole.mkdir(parents=True)
        (self.work / "job.toml").write_text(JOB)
        (self.work / "q.npy").write_bytes(queries(2000))
        self.cache = self.work / "cache"
        subprocess.run([mica, "map", "spectrum", "--resolution", "32", "-o", "map.exr"], cwd=self.work, check=True,
                       capture_output=True)
        evaluate = ["eval", "--map", "../map.exr", "--encoding", "signed", "--ndf", "smooth", "--roughness", "0.1",
                    "--queries", "../q.npy", "-o", "d.npy"]
        render = ["render", "../job.toml", "--skip-finished", "--quiet", "-o", "a.exr"]
        self.tasks = {
            "sequence": [*render, "--json-log", "log.jsonl"],
            "picture": [*render, "--frames", "2"],
            "shard": [*render, "--frames", "1", "--shard", "2/3"],
            "table": evaluate,
            "part": [*evaluate, "--shard", "1/2"],
            "join": ["join", *(f"../whole/b.0001.part-{n}-of-3.exr" for n in (1, 2, 3)), "-o", "joined.exr"],
            "join_table": ["join", "../whole/e.npy.part-1-of-2", "../whole/e.npy.part-2-of-2", "-o", "joined.npy"],
        }
        if count >= 100:
            self.tasks["cache"] = ["warm", "../job.toml"]
        for shard in "123":
            self.run(self.whole, ["render", "../job.toml", "--quiet", "-o", "b.exr", "--frames", "1", "--shard", shard + "/3"])
        for shard in "12":
            self.run(self.whole, [*evaluate[:-1], "e.npy", "--shard", shard + "/2"])
        self.seconds = {}
        for name, arguments in self.tasks.items():
            self.run(self.whole, arguments)
            timed = self.work / "disturbed"  # once more from nothing, but with kernels
            shutil.rmtree(timed, ignore_errors=True)
            timed.mkdir()
            begin = time.monotonic()
            self.run(timed, arguments)
            self.seconds[name] = time.monotonic() - begin
        self.expected = {path.name: path.read_bytes() for path in self.whole.iterdir()}

    def start(self, folder, arguments):
        environment = dict(os.environ, MICA_CACHE_DIR=str(self.cache))
        return subprocess.Popen([self.mica, *arguments], cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE)

    def run(self, folder, arguments):
        process = self.start(folder, arguments)
        message = process.communicate()[1]
        if process.returncode != 0:
            sys.exit(f"{' '.join(arguments)}: exit code {process.returncode}: {message.decode()}")

    def problems(self, folder, may_be_litter):
        found = []
        for path in [*folder.iterdir(), *self.cache.iterdir()]:
            if path.name.endswith(".tmp"):
                found += [] if may_be_litter else [f"{path} was left"]
            elif path.parent == folder and path.suffix != ".jsonl" and path.read_bytes() != self.expected.get(path.name):
                found.append(f"{path} is not what it would be undisturbed")
        return found

    def kill_one(self, number):
        """@return what is wrong."""
        name, arguments = self.random.choice(list(self.tasks.items()))
        folder = self.work / "disturbed"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        if name == "cache":
            shutil.rmtree(self.cache, ignore_errors=True)
            self.cache.mkdir(mode=0o700)
        process = self.start(folder, arguments)
        time.sleep(self.random.uniform(0, 1.1 * self.seconds[name]))
        kind = self.random.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        process.send_signal(kind)
        process.communicate()
        found = self.problems(folder, may_be_litter=kind == signal.SIGKILL)
        self.run(folder, arguments)
        found += self.problems(folder, may_be_litter=False)
        return [f"{number} ({name}, {kind.name}): {problem}" for problem in found], process.returncode


def main():
    mica, work = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    kills = Kills(mica, work, count, int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    failures, hit = [], 0
    for number in range(count):
        found, code = kills.kill_one(number)
        hit += code != 0
        failures += found
    shutil.rmtree(work)
    print("\n".join(failures) or f"{count} runs, {hit} of them killed before their end: nothing half, no litter")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
