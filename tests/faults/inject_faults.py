#!/usr/bin/env python3
"""Whatever call of the system fails, the program says so by its exit code and leaves nothing unfinished behind.

    inject_faults.py MICA FAIL_CALL.so [--most N]

For a small map, eval, ndf and render, the n-th open, write, fsync, rename and allocation fails: every n up to N of
them, else N of them evenly spread. After each: the exit code says what failed, every output is whole or not there,
nothing else was left, and at last a run without a fault writes the same bytes as before.
"""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

KINDS = ("open", "write", "fsync", "rename", "new")
# What may be answered to a fault. 0: what failed was not needed, and the outputs are all there; 2: a job names a file
# that cannot be read; 3: no memory; 4: a file.
CODES = {"open": {0, 2, 4}, "write": {4}, "fsync": {0, 4}, "rename": {4}, "new": {0, 3}}

JOB = """
image = { width = 8, height = 6, subpixels = 1 }
camera = { position = [0, -3, 1] }
surface.m = { file = "wood.exr", encoding = "signed" }
material.a = { surface = "m", roughness = 0.1 }
shape = [{ type = "plane", material = "a" }, { type = "mesh", file = "t.obj", material = "a" }]
light = [{ type = "point", position = [0, 0, 2] }]
background = { image = "wood.exr" }
"""
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
QUERIES = "u,v,cuu,cuv,cvv,s,t\n0.1,0.2,1e-3,0,1e-3,0.01,0.02\n"
MAP = "--map wood.exr --encoding signed --ndf triangles --roughness 0.1"
COMMANDS = {
    "map": ("map spectrum --resolution 16 -o out/a.exr", ["a.exr"]),
    "eval": (f"eval {MAP} --queries q.csv -o out/d.npy --json out/d.json", ["d.npy", "d.json"]),
    "ndf": (f"ndf {MAP} --center 0.5,0.5 --sigma 2 --size 8 -o out/n.exr", ["n.exr"]),
    "render": ("render job.toml -o out/a.exr --json out/a.json --quiet", ["a.exr", "a.png", "a.json"]),
}


class Command:
    def __init__(self, program, library, folder, arguments, outputs):
        self.program, self.library, self.folder = program, library, folder
        self.arguments, self.outputs = arguments.split(), outputs
        self.inputs = set(os.listdir(folder))
        self.expected = {}

    def run(self, kind="", n=0):
        """Exit code, what it said, and how many calls of this kind there were."""
        shutil.rmtree(self.folder / "out", ignore_errors=True)
        reading, writing = os.pipe()
        environment = {
            **os.environ,
            "LD_PRELOAD": str(self.library),
            "MICA_FAIL_CALL": kind,
            "MICA_FAIL_AT": str(n),
            "MICA_FAIL_BELOW": str(self.folder),
            "MICA_FAIL_COUNT": str(writing),
        }
        result = subprocess.run([self.program, *self.arguments], cwd=self.folder, env=environment, pass_fds=[writing],
                                capture_output=True, text=True)
        os.close(writing)
        count = os.read(reading, 64)
        os.close(reading)
        return result.returncode, result.stderr.strip(), int(count or 0)

    def written(self):
        out = self.folder / "out"
        return {path.name: path.read_bytes() for path in out.iterdir()} if out.exists() else {}

    def problems(self, code, kind):
        written = self.written()
        if code not in CODES[kind]:
            yield f"exit code {code}, expected one of {sorted(CODES[kind])}"
        for name in set(written) - set(self.outputs):
            yield f"left {name}"
        for name in set(os.listdir(self.folder)) - self.inputs - {"out"}:
            yield f"left {name}"
        if (self.folder / "out").exists() and not written:
            yield "left an empty folder"
        if code == 0 and set(written) != set(self.outputs):
            yield f"exit code 0 and of {self.outputs} only {sorted(written)}"
        for name, content in written.items():
            if name.endswith(".json"):  # it says how long things took
                if not content.endswith(b"}\n"):
                    yield f"{name} is cut short"
            elif name in self.outputs and content != self.expected[name]:
                yield f"{name} is not what a run without a fault writes"


def chosen(count, most):
    if count <= most:
        return range(1, count + 1)
    return sorted({1 + n * (count - 1) // (most - 1) for n in range(most)})


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=Path)
    parser.add_argument("library", type=Path)
    parser.add_argument("--most", type=int, default=4)
    options = parser.parse_args()
    failures, runs = 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        program, library = options.program.resolve(), options.library.resolve()
        subprocess.run([program, *"map spectrum --resolution 16 --rms-slope 0.2 -o wood.exr".split()], cwd=folder,
                       check=True, capture_output=True)
        for file, text in {"job.toml": JOB, "t.obj": TRIANGLE, "q.csv": QUERIES}.items():
            (folder / file).write_text(text)
        for word, (arguments, outputs) in COMMANDS.items():
            command = Command(program, library, folder, arguments, outputs)
            code, said, _ = command.run()
            if code != 0:
                sys.exit(f"{word} without a fault: exit code {code}\n{said}")
            command.expected = command.written()
            for kind in KINDS:
                _, _, count = command.run(kind)
                if count == 0:
                    failures += 1
                    print(f"{word}: no {kind} was seen")
                for n in chosen(count, options.most):
                    code, said, _ = command.run(kind, n)
                    runs += 1
                    for problem in command.problems(code, kind):
                        failures += 1
                        print(f"{word}, {kind} {n} of {count}: {problem}\n  {said}")
                code, said, _ = command.run()
                if code != 0 or any(command.written().get(o) != command.expected[o] for o in outputs if o[-4:] != "json"):
                    failures += 1
                    print(f"{word}, after {kind}: a run without a fault: exit code {code}\n  {said}")
                print(f"{word}: {kind}, {min(count, options.most)} of {count}", flush=True)
    print(f"{runs} faults, {failures} failures")
    return failures != 0


if __name__ == "__main__":
    sys.exit(main())
