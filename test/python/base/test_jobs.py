# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import importlib.util
import io
import os
import pickle
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
from _pytest.monkeypatch import MonkeyPatch  # pytest.MonkeyPatch since 6.2

from sextant.base.jobs import JobError, SchedulerError, package_folder, run_jobs


class Unportable(Exception):
    """Its __init__ takes other arguments than those it hands on, so that it cannot be unpickled."""

    def __init__(self, name, number):
        super().__init__(f"{name} {number}")


def numbers(seed, count=1000):
    """Sums whose last bits depend on the order of what is summed, and a picture of OpenCV's."""
    random = np.random.default_rng(seed)
    a = random.normal(size=(count, 3))
    picture = cv2.GaussianBlur(random.normal(size=(200, 300)), (7, 7), 1.3)
    return a.T @ a, np.linalg.svd(a)[1], picture.sum(), cv2.getNumThreads()


def late_if_even(number):
    time.sleep(0.0 if number % 2 else 0.3)
    return number, os.getpid()


def fails_at_two(number):
    if number == 2:
        raise Unportable("no", number)
    if number == 3:
        raise OSError(2, "no such thing")
    return number


def dies(number):
    os._exit(number)


def returns_what_cannot_be_sent(number):
    return lambda: number


def sleeps(seconds):
    time.sleep(seconds)


def bits(results):
    return [[np.asarray(value).tobytes() for value in each] for each in results]


@pytest.mark.slow
def test_results_are_the_same_in_one_process_and_in_two():
    job = partial(numbers, count=2000)
    here = list(run_jobs(job, range(4)))
    assert bits(here) == bits(run_jobs(job, range(4), jobs=2))
    assert all(each[3] == 1 for each in here)


@pytest.mark.slow
def test_results_come_in_order_from_other_processes():
    threads = cv2.getNumThreads()
    results = list(run_jobs(late_if_even, range(4), jobs=2))
    assert [number for number, _ in results] == [0, 1, 2, 3]
    assert os.getpid() not in {process for _, process in results}
    assert {process for _, process in run_jobs(late_if_even, [1])} == {os.getpid()}
    assert cv2.getNumThreads() == threads and "OMP_NUM_THREADS" not in os.environ.keys() - BEFORE


BEFORE = set(os.environ)


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_errors(jobs):
    names = [f"{number}.bag" for number in range(4)]
    given = []
    with pytest.raises(JobError, match="^2.bag: .*no 2") as caught:
        given.extend(run_jobs(fails_at_two, range(4), jobs, names=names))
    assert "fails_at_two" in caught.value.trace
    results = list(run_jobs(fails_at_two, range(4), jobs, names=names, return_errors=True))
    assert results[:2] == [0, 1]
    assert str(results[2]) == "2.bag: Unportable: no 2"
    assert isinstance(results[3].cause, OSError) and results[3].cause.errno == 2
    assert str(pickle.loads(pickle.dumps(results[3]))) == str(results[3])


@pytest.mark.slow
def test_a_process_that_dies_and_a_result_that_cannot_be_sent():
    with pytest.raises(JobError, match="first: a worker process died; is there memory"):
        list(run_jobs(dies, [1], jobs=2, names=["first"]))
    with pytest.raises(JobError, match="first: .*(pickle|local object)"):
        list(run_jobs(returns_what_cannot_be_sent, [1], jobs=2, names=["first"]))


@pytest.mark.slow
def test_who_stops_listening_ends_the_jobs():
    start = time.monotonic()
    results = run_jobs(sleeps, [0.0, 60.0, 60.0], jobs=2)
    next(results)
    results.close()
    assert time.monotonic() - start < 20.0


@pytest.mark.slow
def test_ctrl_c_ends_all_processes_without_a_word_of_theirs():
    with two_workers() as process:
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=20.0)
        assert process.returncode != 0
        assert errors.count("Traceback") == 1 and errors.rstrip().endswith("KeyboardInterrupt")
        wait_for(lambda: not session(process.pid), 10.0)


@pytest.mark.slow
def test_workers_end_with_a_process_that_is_killed():
    with two_workers() as process:
        process.kill()
        process.wait(20.0)
        wait_for(lambda: not session(process.pid), 10.0)


@contextlib.contextmanager
def two_workers():
    """A process in a session of its own whose two workers are at work; nothing of it is left at the end."""
    code = "import signal, test_jobs, sextant.base.jobs as j\n"
    code += (
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a shell's background job ignores it
    )
    code += "print('begun', flush=True)\nlist(j.run_jobs(test_jobs.sleeps, [60.0] * 4, jobs=2))\n"
    environment = {**os.environ, "PYTHONPATH": f"{Path(__file__).parent}:{os.environ.get('PYTHONPATH', '')}"}
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment,
        start_new_session=True,
        text=True,
    )
    try:
        assert process.stdout.readline() == "begun\n"
        wait_for(
            lambda: len(children(process.pid)) >= 3, 20.0
        )  # two workers, and what Python tracks them with
        time.sleep(1.0)
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def stat_fields():
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            number, _, rest = (folder / "stat").read_text().partition(" (")
            state, parent, _, in_session = rest.rpartition(") ")[2].split()[:4]
            yield int(number), state, int(parent), int(in_session)


def children(parent):
    return [number for number, _, of, _ in stat_fields() if of == parent]


def session(leader):
    return [number for number, state, _, of in stat_fields() if of == leader and state != "Z"]


def wait_for(condition, seconds):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_is_shown_in_a_terminal_only(monkeypatch):
    for stream, shown in ((Terminal(), True), (io.StringIO(), False)):
        monkeypatch.setattr(sys, "stderr", stream)
        list(run_jobs(abs, [1, 2, 3], progress="bags"))
        assert ("bags: 100%" in stream.getvalue() and "3/3" in stream.getvalue()) == shown
        assert shown or stream.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", Terminal())
    list(run_jobs(abs, [1, 2, 3]))
    assert sys.stderr.getvalue() == ""


def test_what_cannot_be_is_refused_at_once():
    for jobs in (0, -1, 1.5):
        with pytest.raises(ValueError, match="jobs is"):
            run_jobs(abs, [1], jobs)
    with pytest.raises(ValueError, match="1 names of 2 jobs"):
        run_jobs(abs, [1, 2], names=["a"])
    assert list(run_jobs(abs, [], jobs=2)) == []


def test_without_distributed(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SchedulerError, match="apt install python3-distributed"):
        list(run_jobs(abs, [1], scheduler="tcp://127.0.0.1:8786"))


needs_distributed = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None, reason="python3-distributed is not installed"
)


@needs_distributed
def test_a_scheduler_that_is_not_there(monkeypatch):
    monkeypatch.setattr("sextant.base.jobs.CLUSTER_TIMEOUT", 1.0)
    start = time.monotonic()
    for address in ("tcp://127.0.0.1:9", "tcp://[::1]:9", "tcp://127.0.0.1:99999", "nonsense"):
        with pytest.raises(SchedulerError, match="no Dask scheduler answers at"):
            list(run_jobs(abs, [1], scheduler=address))
    assert time.monotonic() - start < 20.0


@pytest.fixture(scope="module")
def cluster():
    """Of one worker process, which finds the package as a shell's would."""
    patch = MonkeyPatch()
    try:
        patch.syspath_prepend(package_folder())
        with local_cluster(1) as cluster:
            yield cluster
    finally:
        patch.undo()


def local_cluster(workers):
    from distributed import LocalCluster

    return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0", host="127.0.0.1")


@pytest.mark.slow
@needs_distributed
def test_a_cluster_gives_the_same_to_the_last_bit(cluster):
    scheduler = cluster.scheduler_address
    assert bits(run_jobs(numbers, range(3), scheduler=scheduler)) == bits(run_jobs(numbers, range(3)))
    results = list(run_jobs(fails_at_two, range(4), scheduler=scheduler, return_errors=True))
    assert results[:2] == [0, 1] and str(results[2]) == "2: Unportable: no 2"
    with pytest.raises(JobError, match="^2: Unportable"):
        list(run_jobs(fails_at_two, range(4), scheduler=scheduler))
    # nothing is left of jobs that were done before: each call is a call
    first, second = (dict(run_jobs(late_if_even, [1], scheduler=scheduler)) for _ in range(2))
    assert first == second and os.getpid() not in first.values()


@pytest.mark.slow
@needs_distributed
def test_a_cluster_without_workers(monkeypatch):
    monkeypatch.setattr("sextant.base.jobs.CLUSTER_TIMEOUT", 1.0)
    with local_cluster(0) as empty, pytest.raises(SchedulerError, match="has no worker"):
        list(run_jobs(abs, [1], scheduler=empty.scheduler_address))
