# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs independent jobs on this machine or on a Dask cluster, with bit-identical results.

Every job runs with one thread of OpenCV, and of BLAS in worker processes, so that N jobs use N cores and sums
do not depend on the number of cores.
"""

import asyncio
import contextlib
import multiprocessing
import os
import pickle
import re
import signal
import socket
import sys
import threading
import traceback
from collections import deque
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor
from typing import Any, Callable, Iterable, Iterator, List, NamedTuple, Optional, Sequence

import cv2
from tqdm import tqdm

import sextant._core

CLUSTER_TIMEOUT = 10.0  # seconds to wait for the scheduler, and then for its first worker

# The libraries read these variables when they are loaded: in a new process before any code of Sextant.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")


class JobError(RuntimeError):
    """A job failed: its name, the exception that it raised (cause), and the traceback (trace)."""

    def __init__(self, name: str, cause: BaseException, trace: str = ""):
        super().__init__(name, cause, trace)
        self.name, self.cause, self.trace = name, cause, trace

    def __str__(self) -> str:
        reason = str(self.cause) or type(self.cause).__name__
        return reason if reason.startswith(self.name) else f"{self.name}: {reason}"


class SchedulerError(RuntimeError):
    """The cluster cannot be used; the text explains what to do."""


class _Outcome(NamedTuple):
    result: Any = None
    error: Optional[BaseException] = None
    trace: str = ""


def run_jobs(
    function: Callable[[Any], Any],
    arguments: Iterable[Any],
    jobs: int = 1,
    scheduler: str = "",
    names: Optional[Sequence[str]] = None,
    return_errors: bool = False,
    progress: str = "",
) -> Iterator[Any]:
    """Calls function(argument) for each argument and yields the results in the order of the arguments.

    :param function: a module's function, so that worker processes can import it (functools.partial is fine)
    :param jobs: number of parallel processes; 1: this process alone
    :param scheduler: tcp://host:port of a Dask cluster to use instead; its workers need Sextant installed
    :param names: job names for errors; default: the arguments
    :param return_errors: yield the JobError of a failed job as its result; False: the first failure ends all
    :param progress: label of the progress bar on stderr, if that is a terminal; empty: no bar
    :raises ValueError: jobs is below 1, or the numbers of names and arguments differ
    :raises JobError: a job failed
    :raises SchedulerError: the cluster does not answer in time, or has no worker
    """
    arguments = list(arguments)
    names = [str(argument) for argument in arguments] if names is None else list(names)
    if not isinstance(jobs, int) or jobs < 1:
        raise ValueError(f"jobs is {jobs}, allowed is a whole number from 1 on")
    if len(names) != len(arguments):
        raise ValueError(f"there are {len(names)} names of {len(arguments)} jobs")
    return _results(_outcomes(function, arguments, jobs, scheduler, progress), names, return_errors)


def _results(outcomes: Iterator[_Outcome], names: List[str], return_errors: bool) -> Iterator[Any]:
    with contextlib.closing(outcomes):
        for name, outcome in zip(names, outcomes):
            if outcome.error is None:
                yield outcome.result
                continue
            error = JobError(name, outcome.error, outcome.trace)
            if not return_errors:
                raise error from outcome.error
            yield error


def _outcomes(
    function: Callable[[Any], Any], arguments: List[Any], jobs: int, scheduler: str, progress: str
) -> Iterator[_Outcome]:
    # disable=None: no bar unless stderr is a terminal
    bar = tqdm(total=len(arguments), desc=progress, disable=None if progress else True, unit="job")
    with bar:
        if scheduler:
            with _cluster(scheduler) as executor:
                yield from _in_order(executor, function, arguments, bar)
        elif jobs == 1:
            yield from _here(function, arguments, bar)
        else:
            with _processes(min(jobs, max(len(arguments), 1))) as executor:
                yield from _in_order(executor, function, arguments, bar)


def _here(function: Callable[[Any], Any], arguments: List[Any], bar: tqdm) -> Iterator[_Outcome]:
    for argument in arguments:
        threads = cv2.getNumThreads()
        try:
            outcome = _call(function, argument)
        finally:
            cv2.setNumThreads(threads)
        bar.update()
        yield outcome


def _call(function: Callable[[Any], Any], argument: Any) -> _Outcome:
    """Runs in a worker. An exception that cannot be pickled would break the whole pool."""
    cv2.setNumThreads(1)
    try:
        return _Outcome(function(argument))
    except Exception as error:
        return _Outcome(error=_portable(error), trace=traceback.format_exc())


def _portable(error: Exception) -> Exception:
    try:
        if str(pickle.loads(pickle.dumps(error))) == str(error):
            return error
    except Exception:  # whatever its own __init__ or __reduce__ raises
        pass
    return RuntimeError(f"{type(error).__name__}: {error}")


def _in_order(
    executor: Executor, function: Callable[[Any], Any], arguments: List[Any], bar: tqdm
) -> Iterator[_Outcome]:
    with worker_environment():
        waiting = deque(_submitted(executor, function, argument) for argument in arguments)
    for future in waiting:
        future.add_done_callback(lambda _: bar.update())
    while waiting:
        yield _outcome(waiting.popleft())


def _submitted(executor: Executor, function: Callable[[Any], Any], argument: Any) -> Future:
    try:
        return executor.submit(_call, function, argument)
    except BrokenExecutor as error:
        failed: Future = Future()
        failed.set_exception(error)
        return failed


def _outcome(future: Future) -> _Outcome:
    try:
        return future.result()
    except BrokenExecutor:
        return _Outcome(error=RuntimeError("a worker process died; is there memory for so many jobs?"))
    except CancelledError:
        return _Outcome(error=RuntimeError("it was cancelled; was the cluster shut down?"))
    except Exception as error:  # arguments or results that cannot be pickled, a worker without Sextant
        return _Outcome(error=error)


@contextlib.contextmanager
def _processes(count: int) -> Iterator[Executor]:
    others = set(multiprocessing.active_children())
    # spawn: a fork would copy the locks of OpenCV's and ROS's threads
    executor = ProcessPoolExecutor(count, multiprocessing.get_context("spawn"), _initialize_worker)
    finished = False
    try:
        yield executor
        finished = True
    finally:
        if not finished:  # terminate the workers: cancelling the futures of a broken pool can hang
            for child in set(multiprocessing.active_children()) - others:
                child.terminate()
        executor.shutdown()


def _initialize_worker() -> None:
    """Ignores Ctrl-C, which reaches all processes of the terminal: the parent ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_exit_with_parent, daemon=True).start()


def _exit_with_parent() -> None:
    """Ends this worker when its parent was killed; it would wait for more jobs for ever."""
    multiprocessing.parent_process().join()
    os._exit(1)


@contextlib.contextmanager
def worker_environment(threads: int = 1) -> Iterator[None]:
    """Sets what child processes inherit: threads, huge pages, this package's path, and SIGINT blocked.

    In a devel space of catkin, the package's sources come first in sys.path, and they lack _core.
    """
    # OpenCV allocates and frees megabytes for each image: on huge pages that takes a quarter less time.
    variables = {**dict.fromkeys(_THREADS, str(threads)), "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1"}
    before, path = {name: os.environ.get(name) for name in variables}, list(sys.path)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(variables)
    sys.path.insert(0, package_folder())
    try:
        yield
    finally:
        sys.path[:] = path
        for name, value in before.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def package_folder() -> str:
    """Returns the folder that must come first in sys.path for `import sextant` to find the whole package."""
    return os.path.dirname(os.path.dirname(next(iter(sextant._core.__path__))))


@contextlib.contextmanager
def _cluster(address: str) -> Iterator[Executor]:
    try:
        from distributed import Client
    except ImportError:
        raise SchedulerError(
            "a Dask cluster needs distributed, which is not installed: apt install python3-distributed"
        ) from None
    try:
        _require_scheduler(address)
        client = Client(address, timeout=CLUSTER_TIMEOUT, set_as_default=False)
    except (OSError, ValueError, asyncio.TimeoutError) as error:
        how = "start one with `dask-scheduler`, workers with `dask-worker ADDRESS`"
        raise SchedulerError(f"no Dask scheduler answers at '{address}' ({error}); {how}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=CLUSTER_TIMEOUT)
        except (OSError, asyncio.TimeoutError):
            how = f"start some with `dask-worker {address}`"
            raise SchedulerError(f"the Dask scheduler at '{address}' has no worker; {how}") from None
        # pure=False: repeat a job at every call, as without a cluster
        executor = client.get_executor(pure=False)
        try:
            yield executor
        finally:
            executor.shutdown(wait=False)  # cancels the remaining jobs


def _require_scheduler(address: str) -> None:
    """Connects once: a Client that cannot connect fills the log for long.

    :raises ValueError: not an address; OSError: no process listens at the address
    """
    parts = re.fullmatch(r"(?:tcp|tls)://(?:\[(.+)\]|([^:/]+)):(\d{1,5})", address)
    if not parts:
        raise ValueError("an address is written as tcp://host:port")
    host = parts.group(1) or parts.group(2)
    try:
        socket.create_connection((host, int(parts.group(3))), CLUSTER_TIMEOUT).close()
    except OverflowError:
        raise ValueError("a port is at most 65535") from None
