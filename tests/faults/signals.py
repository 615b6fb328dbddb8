#!/usr/bin/env python3
"""SIGINT and SIGTERM end every phase of every command soon, by 130 and 143, and nothing is left.

    signals.py MICA WORK [--times N] [--longest SECONDS] [--limit SECONDS] [PHASE ...]

Each command below is mostly one phase: reading, building, calibration, rendering, writing and so on. It is run once
undisturbed, for some seconds at most; then it gets each signal at N times, evenly spread over that. It must end within
the limit by what a shell calls 128 and the signal, or by 0 where it was done before. No temporary file may be left, in its
folder or in the cache, and no output that is not that of the undisturbed run, byte by byte. Prints a table: the longest
time to the end, and how often it was hit. Exit code: 0 when all of it holds and every command was hit.
"""
import argparse
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "farm"))
from kills import queries  # noqa: E402

SCENE = """
camera = {{ position = [0, -3, 1] }}
surface.m = {{ {surface} }}
material.a = {{ surface = "m", roughness = 0.02, repeat = [4, 4], ndf = "{ndf}" }}
shape = [{{ type = "plane", size = 3, material = "a" }}]
light = [{{ type = "point", position = [0, 2, 2] }}]
image = {{ width = {width}, height = {height}, subpixels = {subpixels} }}
"""
BEFORE_MAIN = 0.5  # seconds, on a busy machine
LARGE = 'file = "large.exr", encoding = "signed"'


def scene(surface='generate = "spectrum", resolution = 256', ndf="triangles", width=64, height=48, subpixels=2):
    return SCENE.format(surface=surface, ndf=ndf, width=width, height=height, subpixels=subpixels)


JOBS = {
    "small": scene(),
    "reading": scene(LARGE),
    "generating": scene('generate = "spectrum", resolution = 8192'),
    "building": scene(LARGE, ndf="gaussians"),
    "calibration": scene(ndf="auto", width=640, height=360, subpixels=4),
    "rendering": scene(width=1920, height=1080, subpixels=8),
    "sky": scene(width=3072, height=3072, subpixels=1).replace("1] }", "1], look_at = [0, -6, 2] }", 1)
    + "background = { color = [0.1, 0.2, 0.3] }\n",
    "energies": scene(ndf="cavities") + "background = { color = [1, 1, 1] }\n",
}


def map_of(ndf, name="map"):
    return f"--map ../inputs/{name}.exr --encoding signed --ndf {ndf} --roughness 0.005"


def render(job):
    return f"render ../inputs/{job}.toml --quiet -o a.exr"


# Phase, arguments, and whether kernels are compiled anew.
PHASES = [
    ("render: reading", render("reading"), False),
    ("render: generating", render("generating"), False),
    ("render: building", render("building"), False),
    ("render: compiling", render("small"), True),
    ("render: calibration", render("calibration"), False),
    ("render: rendering", render("rendering"), False),
    ("render: writing", render("sky"), False),
    ("render: energies", render("energies"), False),
    ("check: reading", "check ../inputs/reading.toml", False),
    ("check: generating", "check ../inputs/generating.toml", False),
    ("check: estimate", "check ../inputs/calibration.toml", False),
    ("map", "map scratches --resolution 8192 -o m.exr", False),
    ("eval: reading", f"eval {map_of('smooth')} --queries ../inputs/queries.csv -o d.npy", False),
    ("eval: triangles", f"eval {map_of('triangles')} --queries ../inputs/queries.npy -o d.npy", False),
    ("eval: reference", f"eval {map_of('reference')} --queries ../inputs/queries.npy -o d.npy", False),
    ("eval: auto", f"eval {map_of('auto')} --queries ../inputs/queries.npy -o d.npy", False),
    ("ndf: reading", f"ndf {map_of('triangles', 'large')} --center 0.5,0.5 --sigma 8 -o n.exr", False),
    ("ndf", f"ndf {map_of('reference')} --center 0.5,0.5 --sigma 24 --size 1024 -o n.exr", False),
    ("warm", "warm ../inputs/calibration.toml", True),
    ("join", "join ../inputs/part.part-1-of-2.exr ../inputs/part.part-2-of-2.exr -o joined.exr", False),
    ("bench", "bench tiny --quiet", False),
    ("selftest", "selftest", False),
]


class Work:
    def __init__(self, mica, folder, longest):
        self.mica, self.folder, self.longest = os.path.abspath(mica), Path(folder).resolve(), longest
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.inputs = self.folder / "inputs"
        self.inputs.mkdir()
        self.cache = self.folder / "cache"

    def start(self, arguments, folder):
        environment = dict(os.environ, MICA_CACHE_DIR=str(self.cache), POCL_CACHE_DIR=str(self.cache / "pocl"))
        return subprocess.Popen([self.mica, *arguments], cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE)

    def run(self, *arguments):
        process = self.start(arguments, self.inputs)
        message = process.communicate()[1].decode()
        if process.returncode != 0:
            sys.exit(f"mica {' '.join(arguments)}: exit code {process.returncode}: {message}")

    def make_input(self, name):
        if (self.inputs / name).exists():
            return
        if name.endswith(".toml"):
            (self.inputs / name).write_text(JOBS[name[:-5]])
            if "large.exr" in JOBS[name[:-5]]:
                self.make_input("large.exr")
        elif name == "large.exr":
            self.run("map", "spectrum", "--resolution", "4096", "-o", name)
        elif name == "map.exr":
            self.run("map", "spectrum", "--resolution", "256", "-o", name)
        elif name == "queries.npy":
            (self.inputs / name).write_bytes(queries(200_000))
        elif name == "queries.csv":
            (self.inputs / name).write_text("u,v,cuu,cuv,cvv,s,t\n" + "0.37,0.21,1e-3,1e-4,1e-3,0.1,0.05\n" * 600_000)
        elif name == "part.part-1-of-2.exr":
            self.make_input("sky.toml")
            for shard in "12":
                self.run("render", "sky.toml", "--quiet", "-o", "part.exr", "--shard", shard + "/2")

    def signalled(self, arguments, compiles, number, delay):
        """@return seconds from the signal to the end, exit code, what was left."""
        outputs = self.folder / "outputs"
        shutil.rmtree(outputs, ignore_errors=True)
        outputs.mkdir()
        if compiles:
            shutil.rmtree(self.cache, ignore_errors=True)
        process = self.start(arguments, outputs)
        try:
            message = process.communicate(timeout=delay)[1]
            begin = time.monotonic()
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            begin = time.monotonic()
            message = process.communicate()[1]
        seconds = time.monotonic() - begin
        left = [str(path) for path in self.folder.rglob("*.tmp") if "pocl" not in path.parts]
        written = {path.name: path.read_bytes() for path in outputs.iterdir()}
        if process.returncode == 0 and not self.expected:
            self.expected = written
        if number != signal.SIGKILL and written and not self.expected:  # of a command that takes longer
            self.signalled(arguments, compiles, signal.SIGKILL, None)
        left += [name for name, content in written.items() if content != self.expected.get(name)]
        return seconds, process.returncode, left, message.decode(errors="replace")

    def duration(self, arguments, compiles):
        """Seconds of an undisturbed run, up to the longest that is looked at; notes what it writes."""
        self.expected = {}
        for path in [*filter(None, (word.partition("inputs/")[2] for word in arguments))]:
            self.make_input(path)
        for _ in range(1 if compiles else 2):  # the first time kernels are compiled
            begin = time.monotonic()
            _, code, _, message = self.signalled(arguments, compiles, signal.SIGKILL, self.longest)
            if code not in (0, -signal.SIGKILL):
                sys.exit(f"mica {' '.join(arguments)}: exit code {code}: {message}")
            seconds = min(time.monotonic() - begin, self.longest)
        return seconds


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("mica")
    parser.add_argument("work")
    parser.add_argument("--times", type=int, default=3)
    parser.add_argument("--longest", type=float, default=10.0)
    parser.add_argument("--limit", type=float, default=1.0)
    parser.add_argument("phases", nargs="*")
    options = parser.parse_intermixed_args()
    work = Work(options.mica, options.work, options.longest)
    failures = 0
    print(f"{'phase':22} {'SIGINT':>16} {'SIGTERM':>16}   longest seconds to the end, times hit")
    for phase, text, compiles in PHASES:
        if options.phases and phase not in options.phases:
            continue
        arguments = text.split()
        duration = work.duration(arguments, compiles)
        row, problems = "", []
        for number in (signal.SIGINT, signal.SIGTERM):
            longest, hits = 0.0, 0
            for n in range(options.times):
                delay = duration * (n + 0.5) / options.times
                seconds, code, left, _ = work.signalled(arguments, compiles, number, delay)
                # The latter where the program had not begun yet.
                stopped = code == 128 + number or (code == -number and delay < BEFORE_MAIN)
                longest, hits = max(longest, seconds), hits + stopped
                when = f"{number.name} after {delay:.2f} s"
                if code != 0 and not stopped:
                    problems.append(f"{when}: exit code {code}")
                if seconds > options.limit:
                    problems.append(f"{when}: took {seconds:.2f} s to end")
                problems += [f"{when}: left {path}" for path in left]
            row += f" {longest:8.2f} s, {hits:2}/{options.times:2}"
            if hits == 0:
                problems.append(f"{number.name} never hit it")
        print(f"{phase:22}{row}   of {duration:.1f} s", flush=True)
        for problem in problems:
            print(f"    {problem}", flush=True)
        failures += len(problems)
    shutil.rmtree(work.folder)
    return failures != 0


if __name__ == "__main__":
    sys.exit(main())
