#!/usr/bin/env python3
"""A sequence takes no more memory the longer it is.

    soak.py MICA WORK [FRAMES [WARM]]

Renders FRAMES small frames of a moving sea in one process, by `auto` and by `triangles`. What is resident after the last
ones may be 1% above that after frame WARM. Exit code: 0 when it is.
"""
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

JOB = """image = {{ width = 16, height = 9, subpixels = 1 }}
frames = {{ range = [0, {last}] }}
camera = {{ position = [0, -3, 1], keys = [{{ frame = 0 }}, {{ frame = {last}, position = [1, -3, 1] }}] }}
surface.waves = {{ generate = "waves", resolution = 64, patch = 60 }}
surface.bumps = {{ generate = "spectrum", resolution = 64 }}
material.sea = {{ surface = "waves", roughness = 0.1, ndf = "{ndf}" }}
material.gold = {{ surface = "bumps", roughness = 0.05, ndf = "{ndf}" }}
shape = [{{ type = "sphere", material = "sea" }}, {{ type = "plane", material = "gold" }}]
light = [{{ type = "point", position = [1.6, -3.6, 3.4], intensity = [25, 25, 25] }}]
"""


def resident_kib(process):
    for line in Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    return 0  # it has ended


def resident_over_frames(mica, folder, ndf, frames):
    """(frames that are done, KiB), many times."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "job.toml").write_text(JOB.format(last=frames - 1, ndf=ndf))
    process = subprocess.Popen([mica, "render", "job.toml", "--quiet", "-o", "a.exr"], cwd=folder,
                               stderr=subprocess.DEVNULL)
    seen = []
    while process.poll() is None:
        seen.append((len(list(folder.glob("a.*.exr"))), resident_kib(process)))
        time.sleep(0.02)
    if process.returncode != 0:
        sys.exit(f"{ndf}: exit code {process.returncode}")
    return [(done, kib) for done, kib in seen if kib > 0]


def main():
    mica, work = os.path.abspath(sys.argv[1]), Path(sys.argv[2])
    frames = int(sys.argv[3]) if len(sys.argv) > 3 else 500
    warm = int(sys.argv[4]) if len(sys.argv) > 4 else frames // 10
    failed = False
    for ndf in ("triangles", "auto"):
        seen = resident_over_frames(mica, work, ndf, frames)
        at_warm = max(kib for done, kib in seen if done <= warm)
        at_end = max(kib for done, kib in seen if frames - 10 <= done < frames)  # then it says what it did
        print(f"{ndf}: {at_warm} KiB to frame {warm}, {at_end} KiB after {frames}: {at_end / at_warm - 1:+.2%}")
        failed |= at_end > 1.01 * at_warm
    shutil.rmtree(work)
    sys.exit(failed)


if __name__ == "__main__":
    main()
