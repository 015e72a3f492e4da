"""A batch on a cluster of two workers, one of which is killed in the middle of a job.

    dask_batch_test.py SONARCAL DASK_BATCH FOLDER

FOLDER has plan.json and `whole`, the same batch run by processes. Prints "ok" and ends with 0 where the cluster's
outputs are those of `whole`, every job is done once, and the worker was killed while it had a job.
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import distributed

LEFT_OUT = {"provenance.json", "report.html"}  # which have hashes of inputs that name the folder


def events_of(out):
    """Each job's events."""
    events = {}
    ledger = out / "ledger.jsonl"
    if not ledger.exists():
        return events
    for line in ledger.read_text().split("\n")[:-1]:
        entry = json.loads(line)
        events.setdefault(entry["job"], []).append(entry["event"])
    return events


def outputs_of(out):
    """Every output file's bytes, by its path, with one name for the batch's folder."""
    return {
        str(path.relative_to(out)): path.read_bytes().replace(str(out).encode(), b"OUT")
        for entry in ("sim", "judged")
        for path in sorted((out / entry).rglob("*"))
        if path.is_file() and path.name not in LEFT_OUT
    }


def children_of(process):
    """Ids of a process's children, of its threads all."""
    ids = []
    try:
        for task in pathlib.Path(f"/proc/{process}/task").iterdir():
            ids += [int(word) for word in (task / "children").read_text().split()]
    except OSError:  # it, or a thread of it, has ended
        pass
    return ids


def job_of(process):
    """The job that a process runs, as in `sonarcal batch ... --only JOB`; None if it runs none."""
    words = pathlib.Path(f"/proc/{process}/cmdline").read_text().split("\0")
    return words[words.index("--only") + 1] if "--only" in words else None


def is_busy(runner, out):
    """True if the process runs a job that has started and has not ended, by the ledger."""
    return events_of(out).get(job_of(runner), ["none"])[-1] == "started"


def wait_for_a_job(out, batch, limit_s):
    """Returns when one job is done or the batch has ended."""
    end = time.monotonic() + limit_s
    while not any("done" in events for events in events_of(out).values()) and batch.poll() is None:
        assert time.monotonic() < end, f"no job was done in {limit_s} s: {events_of(out)}"
        time.sleep(0.005)


def kill_a_busy_worker(workers, out, deadline_s):
    """Kills the first worker that is in the middle of a job, and the process that runs the job.

    This process keeps the ledger. It is stopped first, so that the job cannot end before the kill.
    """
    end = time.monotonic() + deadline_s
    while time.monotonic() < end:
        for worker in workers:
            for runner in children_of(worker):
                try:
                    if is_busy(runner, out) and kill_both(worker, runner, out):
                        return worker
                except OSError:  # one of them has ended
                    continue
        time.sleep(0.005)
    return None


def kill_both(worker, runner, out):
    """Kills a worker and the process of its job if the job has not ended; False if it has."""
    os.kill(runner, signal.SIGSTOP)
    try:
        if is_busy(runner, out):
            os.kill(worker, signal.SIGKILL)
            os.kill(runner, signal.SIGKILL)
            return True
    except OSError:  # the worker has ended
        pass
    os.kill(runner, signal.SIGCONT)
    return False


def main():
    """The test."""
    sonarcal, dask_batch, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    out = folder / "cluster"
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        workers = [worker.process.process.pid for worker in cluster.workers.values()]
        command = [sys.executable, dask_batch, str(folder / "plan.json"), "--out", str(out)]
        command += ["--scheduler", cluster.scheduler_address, "--program", sonarcal]
        with subprocess.Popen(command) as batch:
            try:
                wait_for_a_job(out, batch, 300)  # so that the kill comes in the middle
                killed = kill_a_busy_worker(workers, out, 60)
                status = batch.wait(timeout=300)
            finally:
                batch.kill()  # which otherwise would be waited for without limit
    assert killed is not None, "no worker was seen with a job"
    assert status == 0, f"dask_batch ended with {status}"
    events = events_of(out)
    assert len(events) == 8, events
    for job, of_job in events.items():
        assert of_job.count("done") == 1 and of_job[-1] == "done", (job, of_job)
    begun_again = [job for job, of_job in events.items() if of_job.count("started") > 1]
    assert len(begun_again) == 1, events
    outputs, expected = outputs_of(out), outputs_of(folder / "whole")
    assert len(expected) > 8 and outputs.keys() == expected.keys()
    differing = [name for name, content in expected.items() if outputs[name] != content]
    assert not differing, differing
    assert json.loads((out / "summary.json").read_text())["done"] == 8
    # Run again there is nothing to do.
    ledger = (out / "ledger.jsonl").read_bytes()
    again = [sys.executable, dask_batch, str(folder / "plan.json"), "--out", str(out), "--workers", "1"]
    assert subprocess.run(again + ["--program", sonarcal], check=False).returncode == 0
    assert (out / "ledger.jsonl").read_bytes() == ledger
    print("ok: killed worker", killed, "with", begun_again)


if __name__ == "__main__":
    main()
