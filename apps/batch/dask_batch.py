#!/usr/bin/env python3
"""Runs the jobs of a batch on a Dask cluster, with the plan and the ledger of `sonarcal batch`.

    dask_batch.py PLAN --out DIR --scheduler tcp://head:8786
    dask_batch.py PLAN --out DIR --workers 4            a cluster of its own, on this machine

Every worker needs the program and sees PLAN, its inputs and DIR under the same paths. A job runs as
`sonarcal batch PLAN --out DIR --only JOB`, which holds a lock and keeps the ledger: a worker may be killed at any
moment, its job goes to another, and no job is done twice. What a former run did is left alone, whether it ran
here or by `sonarcal batch` itself. At the end the summary is written, and the exit status is that of
`sonarcal batch`: 0 where all is done, 1 where jobs failed.

Needs Debian's python3-distributed.
"""

import argparse
import json
import subprocess
import sys

import distributed


def run_job(program, plan, out, job, threads, after):
    """One job, on a worker. `after` holds the outcomes of the jobs before it: (id, state)."""
    if any(state != "done" for _, state in after):
        return (job, "waiting")
    command = [program, "batch", plan, "--out", out, "--only", job, "--threads", str(threads), "--json", "--quiet"]
    ended = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if ended.returncode < 0:  # killed, as the worker may be the next moment: let another try
        raise RuntimeError(f"{job}: ended by signal {-ended.returncode}")
    if ended.returncode != 0:
        sys.stderr.write(ended.stderr)
    return (job, "done" if ended.returncode == 0 else "failed")


def list_jobs(arguments):
    """The plan's jobs with their states, as `sonarcal batch --dry-run` has them."""
    command = [arguments.program, "batch", arguments.plan, "--out", arguments.out, "--dry-run", "--json"]
    ended = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if ended.returncode != 0:
        sys.exit(ended.returncode)
    return json.loads(ended.stdout)["jobs"]


def run_batch(client, arguments):
    """Submits what is not done, each job after the one it needs, and waits."""
    futures = {}
    for job in list_jobs(arguments):
        if job["state"] == "done":
            continue
        futures[job["job"]] = client.submit(
            run_job,
            arguments.program,
            arguments.plan,
            arguments.out,
            job["job"],
            arguments.threads,
            [futures[before] for before in job["after"].split(",") if before in futures],
            key=f"sonarcal-{arguments.out}-{job['job']}",
            pure=False,
            retries=arguments.retries,
        )
    failed = 0
    for done, (future, outcome) in enumerate(
        distributed.as_completed(list(futures.values()), with_results=True, raise_errors=False), start=1
    ):
        if future.status == "error":
            print(f"dask_batch: {outcome[1]}", file=sys.stderr)
            failed += 1
        elif not arguments.quiet:
            print(f"dask_batch: {done} of {len(futures)}: {outcome[0]} {outcome[1]}", file=sys.stderr)
    return failed


def read_arguments():
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter
    )
    parser.add_argument("plan", metavar="PLAN", help="plan of the batch (sonarcal-batch/1, JSON)")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of outputs, ledger and summary")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--scheduler", metavar="ADDRESS", help="scheduler of a running cluster")
    where.add_argument("--workers", type=int, metavar="N", help="workers of a cluster of its own, on this machine")
    parser.add_argument("--program", default="sonarcal", metavar="FILE", help="the program on the workers")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="threads of each job")
    parser.add_argument("--retries", type=int, default=3, metavar="N", help="times that a killed job is tried again")
    parser.add_argument("--quiet", action="store_true", help="print nothing but results and errors")
    return parser.parse_args()


def main():
    """Runs the batch and writes its summary."""
    arguments = read_arguments()
    if arguments.scheduler:
        with distributed.Client(arguments.scheduler) as client:
            failed = run_batch(client, arguments)
    else:
        with distributed.LocalCluster(
            n_workers=arguments.workers, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster, distributed.Client(cluster) as client:
            failed = run_batch(client, arguments)
    summary = subprocess.run(
        [arguments.program, "batch", arguments.plan, "--out", arguments.out, "--summary"], check=False
    )
    return summary.returncode if failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
