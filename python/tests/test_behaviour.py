"""What a good module does: it lets others run, stops when it is told, and leaves nothing behind."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import weakref

import numpy as np
import pytest

import mica
from conftest import rows_of


def python(text, **options):
    """A program of its own, with the leak check of the bindings."""
    program = [sys.executable, "-c", textwrap.dedent(text)]
    environment = {**os.environ, "MICA_LEAK_WARNINGS": "1"}
    return subprocess.run(program, capture_output=True, text=True, check=False, env=environment, timeout=120, **options)


def test_what_a_callback_raises_passes_through(triangles, rows):
    class OwnError(Exception):
        pass

    def progress(done, all):
        raise OwnError(done, all)

    with pytest.raises(OwnError) as raised:
        triangles.eval(rows, progress=progress)
    assert raised.value.args[1] == len(rows)
    assert triangles.eval(rows).max() > 1, "and the evaluator answers as before"


def test_callbacks_are_called_on_the_callers_thread(triangles, rows):
    threads = set()
    triangles.eval(rows, progress=lambda done, all: threads.add(threading.current_thread()))
    assert threads == {threading.current_thread()}


def test_callbacks_hear_the_end(triangles, noise, rows):
    heard = []
    triangles.eval(rows, progress=lambda done, all: heard.append((done, all)))
    assert heard[-1] == (500, 500)
    triangles.pndf([[0.5, 0.5]] * 3, 2, 0.1, 8, progress=lambda done, all: heard.append((done, all)))
    assert heard[-1] == (3, 3)


def test_a_callback_may_ask_again(noise, triangles, rows):
    other = mica.Evaluator(noise, "gaussians")
    found = []
    triangles.eval(rows, progress=lambda done, all: found.append(other.eval(rows)))
    np.testing.assert_array_equal(found[-1], other.eval(rows))


def test_others_run_while_the_engine_computes(noise):
    reference = mica.Evaluator(noise, "reference")
    rows = rows_of(300, 64)
    counted = 0
    computing = threading.Thread(target=reference.eval, args=(rows,))
    started = time.perf_counter()
    computing.start()
    while computing.is_alive():
        counted += 1
        time.sleep(0.002)
    seconds = time.perf_counter() - started
    assert seconds > 0.05, "else there is nothing to see"
    assert counted > seconds / 0.05, "the lock is not held for as long as 50 ms"


def test_threads_share_an_evaluator(triangles, rows):
    expected = triangles.eval(rows)
    found = {}

    def work(n):
        found[n] = [triangles.eval(rows) for _ in range(5)]

    threads = [threading.Thread(target=work, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    for answers in found.values():
        for answer in answers:
            np.testing.assert_array_equal(answer, expected)


LONG = {
    "eval": """
        rows = np.repeat([[0.5, 0.5, 4.0, 0, 4.0, 0.1, 0.1, 0.02]], 10**6, axis=0)
        ask = lambda: mica.Evaluator(noise, "reference").eval(rows)
        """,
    "pndf": """
        ask = lambda: mica.pndf(noise, np.random.rand(3000, 2), 16, 0.02, 256, ndf="triangles")
        """,
    "render": """
        ask = mica.Job({
            "image": {"width": 1920, "height": 1080, "subpixels": 8},
            "camera": {"position": [0, -3, 1], "look_at": [0, 0, 0], "fov": 24},
            "surface": {"bumps": {"generate": "spectrum", "resolution": 64}},
            "material": {"gold": {"surface": "bumps", "specular": {"color": [1, 0.8, 0.4]}}},
            "shape": [{"type": "shell", "material": "gold"}],
            "light": [{"type": "point", "position": [2, -4, 3], "intensity": [25, 25, 25]}],
        }).render
        """,
    "generate": """
        ask = lambda: mica.NormalMap.generate("spectrum", resolution=8192)
        """,
}


@pytest.mark.parametrize("work", LONG)
def test_ctrl_c_is_heard_within_half_a_second(work):
    program = f"""
import numpy as np, mica, os, signal, sys, threading, time
noise = mica.NormalMap.generate("spectrum", resolution=256)
{textwrap.dedent(LONG[work])}
def interrupt():
    global sent
    sent = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(1.5, interrupt).start()
try:
    ask()
    print("ended by itself")
except KeyboardInterrupt:
    print(time.perf_counter() - sent, flush=True)
os._exit(0)
"""
    done = python(program)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 0.5


def test_after_ctrl_c_the_process_ends_by_itself():
    done = python("""
        import os, signal, threading
        import numpy as np, mica
        reference = mica.Evaluator(mica.NormalMap.generate("spectrum", resolution=64), "reference")
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        reference.eval(np.repeat([[0.5, 0.5, 0.001, 0, 0.001, 0.1, 0.1, 0.02]], 10**6, axis=0))
        """)
    assert done.returncode == -signal.SIGINT
    assert "KeyboardInterrupt" in done.stderr
    assert "leaked" not in done.stderr


def test_nothing_is_leaked():
    done = python("""
        import gc
        import numpy as np, mica
        def work():
            map = mica.NormalMap.generate("spectrum", resolution=64)
            evaluator = mica.Evaluator(map, "triangles")
            evaluator.itself = evaluator
            array = map.array
            del map
            evaluator.pndf([[0.5, 0.5]], 4, 0.1, size=8, progress=print)
            try:
                evaluator.eval([[0.0] * 8], progress=print)
            except mica.UsageError:
                pass
            return evaluator, array
        kept = work()
        work()
        gc.collect()
        """)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""


def test_the_leak_check_sees_leaks():
    done = python("""
        import ctypes, mica
        map = mica.NormalMap.generate("spectrum", resolution=64)
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(map._map))
        """)
    assert "leaked 1 instances" in done.stderr


def test_evaluators_outlive_maps_and_cycles_are_collected(rows):
    map = mica.NormalMap.generate("spectrum", resolution=64, rms_slope=0.3)
    evaluator = mica.Evaluator(map, "triangles")
    expected = evaluator.eval(rows)
    del map
    gc.collect()
    np.testing.assert_array_equal(evaluator.eval(rows), expected)
    evaluator.itself = evaluator
    gone = weakref.ref(evaluator)
    del evaluator
    gc.collect()
    assert gone() is None


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_stays_flat_over_calls(triangles, rows):
    def work(times):
        for _ in range(times):
            triangles.eval(rows)
            triangles.pndf([[0.5, 0.5]], 2, 0.1, 8)
            with pytest.raises(mica.UsageError):
                triangles.eval(-rows)

    work(50)
    before = resident_bytes()
    work(250)
    assert resident_bytes() - before < 2**20


def test_without_a_device_it_is_said():
    done = python("""
        import os
        os.environ["OCL_ICD_VENDORS"] = "/nowhere"
        import mica
        print(mica.devices())
        try:
            mica.Evaluator(mica.NormalMap.generate("spectrum", resolution=16))
        except mica.DeviceError as error:
            print(error)
        """)
    assert done.stdout.startswith("[]"), done.stderr
    assert "OpenCL" in done.stdout


def test_forked_children_are_told_to_spawn(triangles, rows):
    code = textwrap.dedent("""
        import os, sys
        import mica
        map = mica.NormalMap.generate("spectrum", resolution=64)
        evaluator = mica.Evaluator(map, "triangles")
        child = os.fork()
        if child == 0:
            try:
                evaluator.eval([[0.5, 0.5, 1e-3, 0, 1e-3, 0, 0, 0.1]])
            except mica.DeviceError as error:
                print(error, flush=True)
            os._exit(0)
        os.waitpid(child, 0)
        """)
    done = python(code)
    assert "spawn" in done.stdout, done.stderr
