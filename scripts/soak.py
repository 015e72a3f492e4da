#!/usr/bin/env python3
"""Runs simulate, compare and fit for an hour, and fails if memory, files, threads or outputs change.

usage: scripts/soak.py [--minutes 60] [--frames 10000] [--part 500] [--free materials,noise]
                       [--sonarcal build/apps/sonarcal] [--module build/python] [--work DIR]

Makes small SYNTHETIC recordings, 48 beams x 100 range bins in the paper's tank: --frames frames in parts of --part.
Then goes through the parts, again and again. Each step does this with one part:

  commands   `sonarcal simulate`, `compare` and `fit`, each as a process of its own
  module     one Python process, which lives to the end, does the same by the Python module
  view       one `sonarcal view`, which lives to the end too: images and figures of the first part, and a stopped fit

After each step the script counts memory, threads and open files of the two that live on, and the files that are left.
The outputs of a part must have the same bytes each time. The first steps are the warm-up: caches fill. Growth is the
max of the last steps less the max of the warm-up. Prints a table. Ends with status 1 if a limit is exceeded, or if
there were too few steps to tell. Needs Linux (/proc) and the Python of the module (/usr/bin/python3).
"""

import argparse
import contextlib
import copy
import hashlib
import json
import math
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
WARM_UP = 5  # steps
MAX_GROWTH_MB = 8  # of the max memory of a process
VIEWED = 20  # frames
RAYS = "96x48"
FIT = {"rays": RAYS, "max_frames": 4, "max_held_out": 2, "starts": 1, "trust_all": True, "max_iterations": 3}
RUN_TIMES = re.compile(rb'"timing_s": \{[^}]*\}|<dt>Time</dt><dd>[^<]*</dd>')  # in fit.json and report.html


def fail(message):
    """Ends the program with one sentence."""
    sys.exit(f"soak.py: {message}")


def process_state(pid):
    """Memory in MB, threads and open files of a process."""
    status = dict(line.split(":", 1) for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines())
    return {"memory_mb": int(status["VmRSS"].split()[0]) / 1024, "threads": int(status["Threads"]),
            "open_files": len(os.listdir(f"/proc/{pid}/fd"))}


def digest_of_files(folder):
    """One hash of the names and bytes of all files."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        digest.update(str(path.relative_to(folder)).encode())
        if path.is_file():
            digest.update(RUN_TIMES.sub(b"", path.read_bytes()))
    return digest.hexdigest()


def without_run_times(answer):
    """A framed answer of `sonarcal view` (apps/view/view_api.h) without the numbers that differ from run to run."""
    (length,) = struct.unpack("<I", answer[:4])
    document = json.loads(answer[4:4 + length])
    for key in ("milliseconds", "sequence", "traced"):
        document.pop(key, None)
    return json.dumps(document).encode() + answer[4 + length:]


class Inputs:
    """Scene, sonar, parameters, and for each part poses and a synthetic recording."""

    def __init__(self, folder):
        self.folder = folder
        self.scene = folder / "scene" / "tank.gltf"
        self.sonar = folder / "sonar.json"
        self.truth = folder / "truth.json"
        self.start = ROOT / "cases" / "tank" / "acoustic_start.json"

    def poses(self, part):
        return self.folder / f"poses_{part:03d}.json"

    def recorded(self, part):
        return self.folder / f"recorded_{part:03d}"

    def make(self, sonarcal, frames, frames_of_part):
        """Writes everything except the recordings. Returns the number of parts."""
        subprocess.run([sonarcal, "scenes", "--only", "tank", "--quiet", "--out", self.scene.parent], check=True,
                       stdout=subprocess.DEVNULL)
        listed = json.loads(subprocess.run([sonarcal, "sonars", "--json"], check=True, capture_output=True).stdout)
        sonar = next(entry["sonar"] for entry in listed["sonars"] if entry["sonar"]["name"].startswith("P900"))
        sonar.update(name="small synthetic sonar", range_bins=100,
                     beam_azimuth_deg=[round(-22.5 + 45 * (beam + 0.5) / 48, 4) for beam in range(48)])
        self.sonar.write_text(json.dumps({"sonar": sonar}))
        given = json.loads((self.scene.parent / "poses_tank.json").read_text())["poses"]
        poses = []
        for i in range(frames):  # near the given poses, no pose twice
            pose = copy.deepcopy(given[i % len(given)]["world_from_sonar"])
            pose["position_m"][0] += 0.2 * math.sin(0.37 * i)
            pose["position_m"][1] += 0.2 * math.sin(0.11 * i + 1)
            poses.append({"world_from_sonar": pose})
        parts = range(0, frames, frames_of_part)
        for part, first in enumerate(parts):
            self.poses(part).write_text(
                json.dumps({"format": "sonar-poses/1", "poses": poses[first:first + frames_of_part]}))
        truth = json.loads((ROOT / "cases" / "tank" / "recording_params.json").read_text())
        truth["model"] = "acoustic"
        self.truth.write_text(json.dumps(truth))
        return len(parts)


class Commands:
    """The commands, each a process of its own."""

    def __init__(self, sonarcal, inputs, out, free):
        self.sonarcal, self.inputs, self.out, self.free = sonarcal, inputs, out, free

    def run(self, name, *words):
        """Runs a command. Returns its max memory in MB and its processor time in s."""
        log = self.inputs.folder / f"{name}.log"
        with open(log, "wb") as file:
            process = subprocess.Popen([self.sonarcal, name, *words, "--quiet"], stdout=file, stderr=file)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            fail(f"sonarcal {name} ended with {process.returncode}: {log.read_text(errors='replace')[-2000:]}")
        return {"memory_mb": usage.ru_maxrss / 1024, "processor_s": usage.ru_utime + usage.ru_stime}

    def simulate(self, part, params, seed, out):
        return self.run("simulate", "--scene", self.inputs.scene, "--sonar", self.inputs.sonar, "--params", params,
                        "--poses", self.inputs.poses(part), "--noise", "--seed", str(seed), "--rays", RAYS,
                        "--out", out)

    def step(self, part):
        """Max memory and processor time of each command, and a hash of all outputs. The next step replaces them."""
        real = self.inputs.recorded(part)
        if not real.exists():
            self.simulate(part, self.inputs.truth, 1, real)
        fit = ["--free", self.free]
        for option, value in FIT.items():
            fit += ["--" + option.replace("_", "-")] + ([] if value is True else [str(value)])
        used = {
            "simulate": self.simulate(part, self.inputs.start, 2, self.out / "simulated"),
            "compare": self.run("compare", "--real", real, "--sim", self.out / "simulated",
                                "--pictures", "0", "--out", self.out / "compared"),
            "fit": self.run("fit", "--real", real, "--scene", self.inputs.scene, "--params",
                            self.inputs.start, *fit, "--out", self.out / "fitted"),
        }
        return used, digest_of_files(self.out)


def work_of_module(folder, free):
    """The process of the Python module: does a step for each part that it reads, and answers with a hash."""
    import sonarcal  # pylint: disable=import-outside-toplevel

    inputs = Inputs(folder)
    for line in sys.stdin:
        digest = hashlib.sha256()
        scene = sonarcal.read_scene(inputs.scene)
        real = sonarcal.open_recording(inputs.recorded(int(line)))
        simulated = sonarcal.simulate(scene, real, inputs.start, real, noise=True, seed=2, rays=RAYS)
        for frame in range(len(simulated)):
            digest.update(simulated[frame].image.value.tobytes())
        fitted = sonarcal.fit(real, scene, inputs.start, free=free.split(","), **FIT)
        for result in (dict(sonarcal.compare(real, simulated)), fitted.parameters):
            digest.update(json.dumps(result, sort_keys=True, default=str).encode())
        print(digest.hexdigest(), flush=True)


class Module:
    """The Python module in a process that lives on."""

    def __init__(self, inputs, free):
        self.process = subprocess.Popen(
            ["/usr/bin/python3", "-B", __file__, "--as-module", inputs.folder, "--free", free],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def step(self, part):
        self.process.stdin.write(f"{part}\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().strip() or fail("the process of the Python module has ended")


class View:
    """`sonarcal view`, which lives on."""

    def __init__(self, sonarcal, inputs, frames_of_part):
        self.process = subprocess.Popen(
            [sonarcal, "view", "--scene", inputs.scene, "--real", inputs.recorded(0), "--params", inputs.start,
             "--rays", RAYS, "--port", "0", "--json", "--quiet"], stdout=subprocess.PIPE, text=True)
        text = ""
        while True:
            line = self.process.stdout.readline()
            text += line
            with contextlib.suppress(json.JSONDecodeError):
                address = json.loads(text)
                break
            if not line:
                fail("sonarcal view has ended")
        self.base = f"http://{address['host']}:{address['port']}"
        self.token = address["token"]
        self.sequence = 0
        self.parameters = json.loads(inputs.start.read_text())
        self.shown = range(0, frames_of_part, max(1, frames_of_part // VIEWED))

    def ask(self, path, body=None):
        request = urllib.request.Request(self.base + path, headers={"X-Sonarcal-Token": self.token},
                                         data=None if body is None else json.dumps(body).encode())
        with urllib.request.urlopen(request, timeout=600) as answer:
            return answer.read()

    def step(self):
        digest = hashlib.sha256()
        state = {"parameters": self.parameters, "noise": True, "client": "soak"}
        for frame in self.shown:
            self.sequence += 1  # an older request than the newest of a client gets no image
            state.update(frame=frame, sequence=self.sequence)
            for path, body in (("render", state), ("compare", state), ("recorded", {"frame": frame})):
                digest.update(without_run_times(self.ask("/api/" + path, body)))
        self.ask("/api/fit/start", {"state": state, "starts": 1})
        time.sleep(1)
        self.ask("/api/fit/stop", {})
        while (fit := json.loads(self.ask("/api/fit")))["state"] in ("running", "stopping"):
            time.sleep(0.2)
        if fit["state"] not in ("done", "stopped"):
            fail(f"the fit of sonarcal view ended as {fit['state']}: {fit.get('error')}")
        return digest.hexdigest()


def run_steps(arguments, folder):
    """All steps: the measured values of each."""
    inputs, out, temporary = Inputs(folder / "inputs"), folder / "out", folder / "tmp"
    for each in (inputs.folder, out, temporary):
        each.mkdir(parents=True)
    os.environ.update(TMPDIR=str(temporary), PYTHONPATH=str(arguments.module.resolve()))
    sonarcal = str(arguments.sonarcal.resolve())
    parts = inputs.make(sonarcal, arguments.frames, arguments.part)
    commands = Commands(sonarcal, inputs, out, arguments.free)
    commands.simulate(0, inputs.truth, 1, inputs.recorded(0))
    module, view = Module(inputs, arguments.free), View(sonarcal, inputs, min(arguments.part, arguments.frames))
    steps, of_part = [], {}
    try:
        end = time.monotonic() + 60 * arguments.minutes
        while time.monotonic() < end:
            part = len(steps) % parts
            used, of_files = commands.step(part)
            digests = {"files": of_files, "module": module.step(part), "view": view.step()}
            first = of_part.setdefault(part, digests)
            changed = [name for name in digests if digests[name] != {**first, "view": of_part[0]["view"]}[name]]
            if changed:
                fail(f"step {len(steps) + 1}, part {part}: other outputs than the first time: {', '.join(changed)}")
            steps.append({
                "used": used,
                "module": process_state(module.process.pid),
                "view": process_state(view.process.pid),
                "left": {"out": len(list(out.rglob("*"))), "tmp": len(list(temporary.rglob("*")))},
            })
            print(json.dumps(steps[-1]), file=sys.stderr, flush=True)
    finally:
        for process in (module.process, view.process):
            process.kill()
            process.wait()
    return steps, parts


def rows(steps):
    """(what, unit, value in each step, limit of the growth or None) of each row of the table."""
    for name in ("simulate", "compare", "fit"):
        yield f"`{name}`: max memory", "MB", [step["used"][name]["memory_mb"] for step in steps], MAX_GROWTH_MB
        yield f"`{name}`: processor time", "s", [step["used"][name]["processor_s"] for step in steps], None
    for name, shown in (("module", "Python module"), ("view", "`view`")):
        yield f"{shown}: memory", "MB", [step[name]["memory_mb"] for step in steps], MAX_GROWTH_MB
        yield f"{shown}: threads", "", [step[name]["threads"] for step in steps], 0
        yield f"{shown}: open files", "", [step[name]["open_files"] for step in steps], 0
    yield "files in the output folders", "", [step["left"]["out"] for step in steps], 0
    yield "files in the temporary folder", "", [step["left"]["tmp"] for step in steps], 0


def main():
    """The program."""
    parser = argparse.ArgumentParser(description="Simulates, compares and fits for an hour.")
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--frames", type=int, default=10000)
    parser.add_argument("--part", type=int, default=500, help="frames of one recording")
    parser.add_argument("--free", default="materials,noise", help="what the fits free; noise takes a tenth of the time")
    parser.add_argument("--sonarcal", type=pathlib.Path, default=ROOT / "build" / "apps" / "sonarcal")
    parser.add_argument("--module", type=pathlib.Path, default=ROOT / "build" / "python")
    parser.add_argument("--work", type=pathlib.Path, help="folder for all files; it is kept")
    parser.add_argument("--as-module", type=pathlib.Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.as_module:
        work_of_module(arguments.as_module, arguments.free)
        return
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # ends the other processes too
    with contextlib.ExitStack() as stack:
        folder = arguments.work
        if folder is None:
            folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="sonarcal-soak-")))
        elif folder.exists():
            fail(f"{folder} exists already")
        steps, parts = run_steps(arguments, folder.resolve())
    print(f"{len(steps)} steps through {parts} parts of {arguments.part} synthetic frames; all outputs repeat\n")
    print("| value | unit | first step | max of the warm-up | max of the last steps | growth | limit |")
    print("|---|---|---|---|---|---|---|")
    exceeded = []
    for name, unit, values, limit in rows(steps):
        warm, last = max(values[:WARM_UP]), max(values[-WARM_UP:])
        allowed = "" if limit is None else f"max {limit}"
        print(f"| {name} | {unit} | {values[0]:.4g} | {warm:.4g} | {last:.4g} | {last - warm:.2g} | {allowed} |")
        if limit is not None and last - warm > limit:
            exceeded.append(name)
    if exceeded:
        fail("grew beyond its limit: " + ", ".join(exceeded))
    if len(steps) < 2 * WARM_UP:
        fail(f"only {len(steps)} steps: growth shows from {2 * WARM_UP} on")


if __name__ == "__main__":
    main()
