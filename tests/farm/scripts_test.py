#!/usr/bin/env python3
"""The scripts for schedulers and the examples of docs/farm.md, with a stand-in for Slurm: `sbatch` runs a script at once.

    scripts_test.py MICA SOURCE WORK
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

SBATCH = """#!/usr/bin/env bash
# Runs every task of a script, one after the other, and says its number; notes how it was called.
count=$(ls calls 2> /dev/null | wc -l) script=${*: -1}
mkdir -p calls && echo "$*" > "calls/$((count + 1))"
last=$(sed -n 's/^#SBATCH --array=0-//p' "$script")
for task in $(seq 0 "${last:-0}"); do
  SLURM_ARRAY_JOB_ID=$((count + 1)) SLURM_ARRAY_TASK_ID=$task SLURM_JOB_ID=$((count + 1)) bash "$script" >> calls.log 2>&1
done
echo "$((count + 1))"
"""
SCONTROL = """#!/usr/bin/env bash
echo "$*" >> requeued
"""
JOB = """image = { width = 8, height = 6, subpixels = 1 }
FRAMES
surface.bumps = { generate = "spectrum", resolution = 32 }
material.gold = { surface = "bumps", roughness = 0.1 }
shape = [{ type = "sphere", material = "gold" }]
light = [{ type = "point", position = [-2, -2, 3], intensity = [30, 30, 30] }]
"""


def check(holds, what):
    if not holds:
        sys.exit(f"scripts_test: {what}")


def main():
    mica, source, work = os.path.abspath(sys.argv[1]), Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
    shutil.rmtree(work, ignore_errors=True)
    (work / "bin").mkdir(parents=True)
    for name, text in (("sbatch", SBATCH), ("scontrol", SCONTROL)):
        (work / "bin" / name).write_text(text)
        (work / "bin" / name).chmod(0o755)
    (work / "bin" / "mica").symlink_to(mica)
    (work / "frames.toml").write_text(JOB.replace("FRAMES", "frames = { range = [1, 5] }"))
    (work / "still.toml").write_text(JOB.replace("FRAMES", ""))
    os.environ["PATH"] = f"{work / 'bin'}:{os.environ['PATH']}"
    os.chdir(work)

    def submit(*arguments):
        return subprocess.run([source / "integrations/slurm/mica-submit", *arguments], capture_output=True, text=True)

    def call(*arguments):
        return subprocess.run(["mica", *arguments], capture_output=True, text=True)

    # A sequence, by tasks of two and of one frame.
    check(call("render", "frames.toml", "-o", "whole/f.exr", "--quiet").returncode == 0, "cannot render")
    done = submit("frames.toml", "--tasks", "3", "-o", "out/f.exr", "--", "--gpus-per-task=1")
    check(done.returncode == 0 and done.stdout == "1 2 3\n", f"mica-submit: {done.stdout}{done.stderr}")
    check("--dependency=afterany:1" in Path("calls/2").read_text(), "the array does not wait for the kernels")
    check("--dependency=afterany:2" in Path("calls/3").read_text(), "the end does not wait for the array")
    check("#SBATCH --gpus-per-task=1\n" in Path("out/slurm/f-array.sh").read_text(), "options do not reach sbatch")
    for file in Path("whole").iterdir():
        check(Path("out", file.name).read_bytes() == file.read_bytes(), f"{file.name} differs: {Path('calls.log').read_text()}")
    check("5 done" in Path("out/status.txt").read_text(), "no status at the end")
    check(Path("out/status.html").exists(), "no page at the end")

    # Again: nothing is made twice. What is worth a retry is requeued, and what is not is not.
    before = Path("out/f.0003.exr").stat().st_ino
    check(submit("frames.toml", "--tasks", "3", "-o", "out/f.exr").returncode == 0, "the second submission")
    check(Path("out/f.0003.exr").stat().st_ino == before, "a finished frame was made again")
    check(not Path("requeued").exists(), "requeued without a reason")
    os.environ["MICA_DEVICE"] = "99"
    os.remove("out/f.0003.exr")
    script = Path("out/slurm/f-array.sh")
    script.write_text(script.read_text().replace("--device auto ", ""))
    subprocess.run(["bash", script], env=dict(os.environ, SLURM_ARRAY_TASK_ID="2", SLURM_JOB_ID="7", SLURM_ARRAY_JOB_ID="7"),
                   capture_output=True)
    check(Path("requeued").read_text() == "requeue 7\n", "a lost device was not requeued")
    del os.environ["MICA_DEVICE"]
    check(submit("frames.toml", "--frames", "9").returncode == 0, "tasks fail for themselves")
    check(Path("requeued").read_text() == "requeue 7\n", "a wrong call was requeued")
    check(submit("none.toml").returncode == 4, "a job that is not there was submitted")

    # One picture in shards.
    check(call("render", "still.toml", "-o", "whole/s.exr", "--quiet").returncode == 0, "cannot render")
    check(submit("still.toml", "--shards", "2", "-o", "out/s.exr").returncode == 0, "cannot submit shards")
    check(Path("out/s.exr").read_bytes() == Path("whole/s.exr").read_bytes(), "the joined picture differs")

    # The example of docs/farm.md.
    example = re.search(r"```python\n(import subprocess.*?)```", (source / "docs/farm.md").read_text(), re.S)[1]
    names = {"__name__": "example"}
    exec(example, names)
    check(names["render"]("1-5", "frames.toml", "out/f.exr") == "frames 1-5: done", "the example")
    check("exit code 2" in names["render"]("9", "frames.toml", "out/f.exr"), "the example does not tell what is wrong")
    print("mica-submit and the examples do what docs/farm.md says")


if __name__ == "__main__":
    main()
