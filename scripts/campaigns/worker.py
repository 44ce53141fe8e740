"""Runs the program many times without starting Python and PETSc anew: one process, which forks
itself for every run.

Reads jobs from its standard input, one JSON object a line: words (the command line behind
``contactsnes``), output (stem of the files of what the run prints), seconds (limit), and perhaps
fault (a name of `planted`), signal (its number, and after how many seconds it is sent), file_size
(most bytes of a file: a full disk), full (whether nothing can be printed). Answers each with a
line: status (negative: killed by that signal), CPU seconds, seconds by the clock. Started by
`scripts/campaign` with whatever Python it is told.
"""

import importlib
import json
import os
import resource
import signal
import sys
import time
from pathlib import Path

WALL = 5.0
"""Seconds by the clock for each of CPU time, at most."""

MEMORY = 8 << 30
"""Bytes that a run may take."""

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]


def start():
    """PETSc, and all of the package that runs use."""
    import petsc4py

    from contactsnes.commands.starting import stay_alone

    stay_alone()
    petsc4py.init(["contactsnes", "-options_left", "no", "-no_signal_handler"])
    from contactsnes.commands import session

    # all that runs import, once, before all forks
    for name in ("branch.accuracy", "branch.branch", "commands.cli", "continuation.bifurcations",
                 "dynamics.overdamped"):
        importlib.import_module(f"contactsnes.{name}")
    session.solver_options()


def child(job):
    """The run, in the forked process: its exit status."""
    for number, end in ((1, "out"), (2, "err")):
        path = "/dev/full" if job.get("full") and number == 1 else f"{job['output']}.{end}"
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(descriptor, number)
        os.close(descriptor)
    from contactsnes.commands import cli

    if job.get("fault"):
        from campaigns import planted

        planted.plant(job["fault"])
    return cli.main(job["words"])


def run(job):
    """Fork, wait for the limit of CPU time, and on a busy machine a few times as long; exit status
    and CPU seconds."""
    signals = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    begin, process = time.monotonic(), os.fork()
    if process == 0:
        status = 70
        try:
            for number in signals:  # as `contactsnes.__main__` has it before and after
                signal.signal(number, lambda number, frame: os._exit(128 + number))
            signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)
            limit = int(job["seconds"]) + 1
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            if job.get("file_size"):
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (job["file_size"], job["file_size"]))
            status = child(job)
            sys.stdout.flush()
            sys.stderr.flush()
        except BaseException:
            import traceback

            traceback.print_exc()
            sys.stderr.flush()
        finally:
            os._exit(status)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)
    return *wait(process, begin, job["seconds"], job.get("signal")), time.monotonic() - begin


def wait(process, begin, seconds, sent=None):
    """Exit status and CPU seconds of a child, which is killed when its time is over (then
    -SIGKILL)."""
    pause = 0.001
    while True:
        done, status, usage = os.wait4(process, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime
        if time.monotonic() - begin > WALL * seconds + 5.0:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            return -signal.SIGKILL, time.monotonic() - begin
        if sent and time.monotonic() - begin > sent[1]:
            os.kill(process, sent[0])
            sent = None
        time.sleep(pause)
        pause = min(0.02, 1.3 * pause)


def main():
    """Serve until the input ends."""
    answers = os.fdopen(os.dup(1), "w")
    start()
    print("ready", file=answers, flush=True)
    for line in sys.stdin:
        print(json.dumps(dict(zip(("status", "seconds", "clock"), run(json.loads(line))))),
              file=answers, flush=True)


if __name__ == "__main__":
    main()
