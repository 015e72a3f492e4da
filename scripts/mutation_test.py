#!/usr/bin/python3
"""Mutation test: changes one formula at a time and counts how many of these mutants a unit test notices.

    scripts/mutation_test.py WORK [--sample N] [--seed S] [--only FOLDER] [--again] [--jobs J]

WORK: folder for the build and the results, such as build-mutants. A second call goes on where the first one stopped. It
tests mutants of changed files again, and keeps the other results.
--sample: draws N mutants at random (default: all). --seed: of the draw (default: 1). --only: mutants of one folder or
file. --again: runs the tests of survivors once more, after tests were added.

Mutants: scripts/mutants.py. Formulas: sim/physics, metrics, calib/models/power_likelihood. Tests: those beside them,
tests/sim/physics, tests/metrics, tests/calib/models/power_likelihood_test.cc, as far as a case takes less than 5 s.
A mutant is killed if a test case that reaches it fails, or takes more than 10 times as long and 1 s more on the
processor.
"""

import argparse
import concurrent.futures
import hashlib
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mutants  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = {"mutants_likelihood": "calib/", "mutants_physics": "sim/", "mutants_metrics": "metrics/"}
MAX_CASE_MS = 5000
BATCHES_MS = [0, 5, 100, 1000, MAX_CASE_MS + 1]  # cheap cases run first
LOCK = threading.Lock()


def load(path, default):
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else default


def save(path, value):
    part = path.with_suffix(".part")
    part.write_text(json.dumps(value), encoding="utf-8")
    part.replace(path)


def place_of(mutant):
    return f"{mutant['file']}:{mutant['start']}:{mutant['end']}:{mutant['change']}"


def find(work):
    """State of a work folder: mutants and results. If a source has changed, keeps the results of all other files."""
    digests = {}
    for place in mutants.PLACES:
        for path in sorted((ROOT / place).rglob("*")) if (ROOT / place).is_dir() else [ROOT / place]:
            if path.is_file():
                digests[str(path.relative_to(ROOT))] = hashlib.sha256(path.read_bytes()).hexdigest()
    state = load(work / "mutants.json", {"mutants": []})
    before = state.get("digests", {})
    if before != digests:
        print("Finding mutants ...", file=sys.stderr)
        kept = {place_of(m): state["results"][str(m["id"])] for m in state["mutants"]
                if str(m["id"]) in state["results"] and before.get(m["file"]) == digests.get(m["file"])}
        files, found = mutants.all_mutants(ROOT)
        results = {str(m["id"]): kept[place_of(m)] for m in found if place_of(m) in kept}
        state = {"digests": digests, "files": files, "mutants": found, "results": results}
        save(work / "mutants.json", state)
    return state


def build(work, state, programs, jobs):
    """Builds the programs. Drops mutants that do not compile, by the place of the error."""
    sources = work / "sources"
    if not (work / "CMakeCache.txt").exists():
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DSONARCAL_BUILD_APPS=OFF", "-DSONARCAL_WITH_PYTHON=OFF",
                   f"-DSONARCAL_MUTANTS={sources}", "-GNinja"]
        mutants.write(ROOT, sources, state["files"], state["mutants"])
        subprocess.run(["cmake", "-S", ROOT, "-B", work, *options], check=True, stdout=sys.stderr)
    while True:
        mutants.write(ROOT, sources, state["files"], state["mutants"])
        done = subprocess.run(["cmake", "--build", work, f"-j{jobs}", "--target", *programs, "--", "-k0"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", check=False)
        if done.returncode == 0:
            return
        bad = set()
        for path, line, column in re.findall(r"^(\S+?):(\d+):(\d+): (?:fatal )?error:", done.stdout, re.MULTILINE):
            path = (work / path).resolve()
            if sources.resolve() in path.parents:
                lines = path.read_text(encoding="ascii").splitlines(keepends=True)
                around = mutants.mutants_at("".join(lines), len("".join(lines[:int(line) - 1])) + int(column))
                bad.update(around[-1:])
        if not bad:
            sys.exit(f"{done.stdout[-4000:]}\nmutation_test.py: the build failed")
        print(f"{len(bad)} mutants do not compile and are left out", file=sys.stderr)
        state["mutants"] = [m for m in state["mutants"] if m["id"] not in bad]
        save(work / "mutants.json", state)


def cases_of(work, programs):
    """Passing test cases of the programs: (ms, program, name, mutants that it reaches), cheapest first."""
    cases = []
    for program in programs:
        reached = work / f"{program}.reached"
        subprocess.run([work / "tests/mutation" / program, reached, "--gtest_brief=1"], check=False, stdout=sys.stderr)
        for line in reached.read_text(encoding="utf-8").splitlines():
            name, ms, *ids = line.split()
            if float(ms) <= MAX_CASE_MS:
                cases.append((float(ms), program, name, frozenset(map(int, ids))))
    return sorted(cases, key=lambda case: case[:3])


def batches(cases):
    """Lists of cases of one program, cheap ones first."""
    for low, high in zip(BATCHES_MS, BATCHES_MS[1:]):
        for program in PROGRAMS:
            of = [case for case in cases if case[1] == program and low <= case[0] < high]
            if of:
                yield program, of


class Runner:
    """Programs that wait for mutants."""

    def __init__(self, work):
        self.work, self.programs = work, {}

    def result_of(self, mutant, cases):
        reaching = [case for case in cases if mutant["id"] in case[3]]
        for program, of in batches(reaching):
            if program not in self.programs:
                self.programs[program] = subprocess.Popen(
                    [self.work / "tests/mutation" / program], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL, encoding="utf-8")
            running = self.programs[program]
            limit_s = math.ceil(1 + 0.01 * sum(case[0] for case in of))
            running.stdin.write(f"{mutant['id']} {limit_s} {':'.join(case[2] for case in of)}\n")
            running.stdin.flush()
            result = running.stdout.readline().strip()
            if not result:
                sys.exit(f"mutation_test.py: {program} ended at mutant {mutant['id']}")
            if result != "survived":
                return result
        return "survived" if reaching else "not reached"


def run(work, state, chosen, cases, jobs):
    results = state["results"]
    open_ones = [m for m in chosen if str(m["id"]) not in results]

    def run_part(part):
        runner = Runner(work)
        for mutant in open_ones[part::jobs]:
            result = runner.result_of(mutant, cases)
            with LOCK:
                results[str(mutant["id"])] = result
                if len(results) % 20 == 0:
                    print(f"{sum(str(m['id']) in results for m in chosen)} of {len(chosen)}", file=sys.stderr)
                    save(work / "mutants.json", state)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(run_part, range(jobs)))
    save(work / "mutants.json", state)


def interval95(part, count):
    """Wilson's interval of a share, in percent."""
    z, p = 1.96, part / count
    middle = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count)) / (1 + z * z / count)
    return 100 * (middle - half), 100 * (middle + half)


def report(state, chosen):
    kinds = ["killed", "timeout", "survived", "not reached"]
    of = {m["id"]: state["results"][str(m["id"])] for m in chosen}
    for m in sorted(chosen, key=lambda m: m["id"]):
        if of[m["id"]] in ("survived", "not reached"):
            print(f"{m['file']}:{m['line']}: {of[m['id']]}: {m['change']}: {m['source'][:120]}")
    print(f"\n| folder | mutants | {' | '.join(kinds)} | killed, % | 95 % interval |\n|---|{'---|' * 7}")
    folders = sorted({str(pathlib.Path(m["file"]).parent) for m in chosen})
    for folder in [*folders, "all"]:
        mine = [of[m["id"]] for m in chosen if folder in ("all", str(pathlib.Path(m["file"]).parent))]
        counts = [mine.count(kind) for kind in kinds]
        low, high = interval95(counts[0] + counts[1], len(mine))
        print(f"| {folder} | {len(mine)} | {' | '.join(map(str, counts))} "
              f"| {100 * (counts[0] + counts[1]) / len(mine):.0f} | {low:.0f}..{high:.0f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--sample", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    work = options.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    state = find(work)
    programs = [program for program, place in PROGRAMS.items()
                if (options.only + "/").startswith(place) or not options.only]
    build(work, state, programs, options.jobs)
    chosen = [m for m in state["mutants"] if m["file"].startswith(options.only)]
    if options.sample:  # a larger sample holds the smaller one
        random.Random(options.seed).shuffle(chosen)
        print(f"{options.sample} of {len(chosen)} mutants, seed {options.seed}", file=sys.stderr)
        chosen = chosen[:options.sample]
    if options.again:
        kept = ("killed", "timeout")
        repeated = {str(m["id"]) for m in chosen if state["results"].get(str(m["id"])) not in kept}
        state["results"] = {key: value for key, value in state["results"].items() if key not in repeated}
    run(work, state, chosen, cases_of(work, programs), options.jobs)
    report(state, chosen)


if __name__ == "__main__":
    main()
