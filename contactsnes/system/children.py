"""Programs that this one starts, and that are not to go on without it."""

import os
import signal
import subprocess
from contextlib import contextmanager

_running = set()


def run(words, environment):
    """A finished program, a ``subprocess.CompletedProcess`` with what it has said.

    Parameters
    ----------
    words : list of str, its command line
    environment : mapping
    """
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env=environment) as child:
        _running.add(child)
        try:
            out, err = child.communicate()
        except BaseException:
            child.kill()
            raise
        finally:
            _running.discard(child)
    return subprocess.CompletedProcess(words, child.returncode, out, err)


@contextmanager
def ended_with_this():
    """Within it SIGTERM, which would end this program at once, ends what `run` has started, too;
    a handler of one's own stays, and signals are the main thread's."""
    def hand_on(number, _):
        for child in tuple(_running):
            child.send_signal(number)
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)

    ours = signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    try:
        if ours:
            signal.signal(signal.SIGTERM, hand_on)
    except ValueError:
        ours = False
    try:
        yield
    finally:
        if ours:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
