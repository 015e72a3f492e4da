"""Long calls: other threads of Python run meanwhile, Ctrl-C ends them, what a callback raises comes out."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import sonarcal
from conftest import ACOUSTIC, PARAMETERS


class Clock(threading.Thread):
    """Notes the time as often as it gets to run."""

    def __init__(self):
        super().__init__(daemon=True)
        self.ticks, self.running = [], True

    def run(self):
        while self.running:
            self.ticks.append(time.perf_counter())
            time.sleep(0.001)

    def within_middle(self, start, end):
        """Ticks in the middle half of a span."""
        quarter = 0.25 * (end - start)
        return sum(start + quarter < tick < end - quarter for tick in self.ticks)


def long_calls(world, recorded):
    """Calls of some tenths of a second that tell nothing before they are done."""
    rays = (1500, 3000)
    big = sonarcal.recording(np.random.default_rng(1).integers(0, 256, (1, 700, 600)).astype(np.float32),
                             sonarcal.PolarAxes(1.0, 8.0, 700, np.linspace(-30, 30, 600)))
    return {
        "simulate": lambda: sonarcal.simulate(world.scene, world.sonar, PARAMETERS, world.poses[0], rays=rays,
                                              normals="depth"),
        "compare": lambda: sonarcal.compare(big, big, sweep_steps=101),
        "residual_view": lambda: sonarcal.residual_view(recorded, world.scene, PARAMETERS, frames=[0], rays=rays),
        "segment": lambda: sonarcal.segment(big[0].image, segmentation="os_cfar", guard=(9, 9), training=(24, 24)),
    }


@pytest.mark.parametrize("name", ["simulate", "compare", "residual_view", "segment"])
def test_other_threads_run_meanwhile(world, recorded, name):
    call = long_calls(world, recorded)[name]
    clock = Clock()
    clock.start()
    start = time.perf_counter()
    call()
    end = time.perf_counter()
    clock.running = False
    clock.join()
    assert end - start > 0.02, "too short to tell"
    assert clock.within_middle(start, end) >= 3


def test_the_clock_stands_still_while_the_gil_is_held(world):
    """The test above can fail: NumPy's sort of objects holds the GIL."""
    clock = Clock()
    clock.start()
    objects = np.random.default_rng(0).random(300_000).astype(object)
    start = time.perf_counter()
    objects.sort()
    end = time.perf_counter()
    clock.running = False
    clock.join()
    assert clock.within_middle(start, end) < max(3, (end - start) * 1000 / 4 / 2)


def fit(world, recorded, **options):
    return sonarcal.fit(recorded, world.scene, PARAMETERS, free=["materials", "display.db_max"], starts=1,
                        rays="48x100", **options)


def explain(world, **options):
    recording = world.simulate(ACOUSTIC, noise=True, bits=12)
    return sonarcal.explain(recording, world.scene, ACOUSTIC, rays="48x100", **options)


def calibrate(world, **options):
    recording = world.simulate(ACOUSTIC, noise=True, bits=12)
    return sonarcal.calibrate(recording, world.scene, rays="48x100", **options)


def locate(world, simulated, **options):
    return sonarcal.locate(simulated, world.scene, floor_material="floor", ray_height=1.0, **options)


def transfer(recorded, **options):
    real = sonarcal.open_recording(recorded)
    masks = sonarcal.recording([sonarcal.segment(frame.image) * 255.0 for frame in real], real.sonar)
    other = sonarcal.recording([frame.image for frame in real], real.sonar, full_scale=real.full_scale)
    return sonarcal.transfer(other, real, masks, train_masks=masks, **options)


RUNS = {
    "simulate": ("Simulating", lambda w, r, s, f, p: w.simulate(progress=p)),
    "check": ("Checking the poses", lambda w, r, s, f, p: w.simulate(progress=p)),
    "compare": ("Comparing", lambda w, r, s, f, p: sonarcal.compare(r, s, progress=p)),
    "save": ("Writing", lambda w, r, s, f, p: sonarcal.open_recording(r).save(f / "saved", progress=p)),
    "trace": ("Tracing", lambda w, r, s, f, p: fit(w, r, progress=p)),
    "fit": ("Fitting", lambda w, r, s, f, p: fit(w, r, progress=p)),
    "explain": ("Fitting", lambda w, r, s, f, p: explain(w, progress=p)),
    "calibrate": ("Fitting", lambda w, r, s, f, p: calibrate(w, progress=p)),
    "locate": ("Fitting", lambda w, r, s, f, p: locate(w, s, progress=p)),
    "judge_noise": ("Judging", lambda w, r, s, f, p: sonarcal.judge_noise(r, ACOUSTIC, progress=p)),
    "transfer": ("Training", lambda w, r, s, f, p: transfer(r, progress=p)),
    "residual_view": ("Tracing", lambda w, r, s, f, p: sonarcal.residual_view(r, w.scene, PARAMETERS, progress=p)),
}


class Enough(Exception):
    pass


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("how", ["exception", "signal"])
def test_a_run_ends_where_its_user_ends_it(world, recorded, simulated, tmp_path, run, how):
    what, call = RUNS[run]
    told = []
    main = threading.main_thread().ident

    def progress(step, done, total):
        told.append((step, done, threading.get_ident() == main))
        if step == what and done == 2:
            if how == "signal":
                signal.raise_signal(signal.SIGINT)
            else:
                raise Enough

    with pytest.raises(KeyboardInterrupt if how == "signal" else Enough):
        call(world, recorded, simulated, tmp_path, progress)
    steps = [(done, by_main) for step, done, by_main in told if step == what]
    after = steps[[done for done, _ in steps].index(2) + 1:]
    if how == "exception":  # each other thread may have begun one more step
        assert len(after) <= max(1, os.cpu_count() - 1), steps
    # Python raises KeyboardInterrupt in its main thread, which may have begun one more step when the signal
    # came. Other threads go on until then.
    assert sum(by_main for _, by_main in after) <= 1, steps
    assert list(tmp_path.iterdir()) == []  # nothing half done is left


# Ctrl-C as it comes: from outside, at a run that has no callback.
SCRIPT = """
    import sys
    import sonarcal
    scene = sonarcal.environment("mockup", bed=True)
    poses = sonarcal.viewpoints("mockup") * 5000
    print("begun", flush=True)
    try:
        sonarcal.simulate(scene, "p900-45", sonarcal.environment_parameters(), poses)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
        sys.exit(7)
"""


def test_ctrl_c_ends_a_run_at_once():
    with subprocess.Popen([sys.executable, "-c", textwrap.dedent(SCRIPT)], stdout=subprocess.PIPE, text=True,
                          env=os.environ) as process:
        assert process.stdout.readline() == "begun\n"
        time.sleep(0.5)
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=60)
    assert rest == "interrupted\n" and process.returncode == 7


def test_threads_may_share_a_recording(recorded):
    recording = sonarcal.open_recording(recorded)
    expected = [np.array(frame.image.value) for frame in recording]
    wrong = []

    def read():
        for _ in range(20):
            for index, value in enumerate(expected):
                if not np.array_equal(recording[index].image.value, value):
                    wrong.append(index)

    threads = [threading.Thread(target=read) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
