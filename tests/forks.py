"""The command in forks of one process that has imported what commands import: a call is a process
of its own, but for the start of the interpreter."""

import gc
import importlib
import json
import os
import socket
import subprocess
import sys
import tempfile

BYTES = 2 ** 20
"""Room for the words of a call."""
IMPORTED = tuple(f"contactsnes.{name}" for name in (
    "commands.cli", "commands.showing", "branch.branch", "branch.advice", "branch.costs",
    "output.archive", "output.figures"))
"""What most commands import, here or later."""
SERVER = ("import socket, sys; sys.path.insert(0, {tests!r}); import forks; "
          "forks.serve(socket.socket(fileno={number})); "
          "from contactsnes.__main__ import main; main()")


def serve(connection):
    """Fork for each call that comes, and tell its status; return in forks alone, in the folder of
    the call, with its words and streams."""
    import petsc4py.lib

    petsc4py.lib.ImportPETSc()  # which begins nothing
    for name in IMPORTED:
        importlib.import_module(name)
    gc.freeze()
    while True:
        text, streams, *_ = socket.recv_fds(connection, BYTES, 2)
        if not text:
            os._exit(0)
        pid = os.fork()
        if not pid:
            break
        for number in streams:
            os.close(number)
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        connection.sendall(json.dumps(status).encode())
    connection.close()
    for number, stream in enumerate(streams, start=1):
        os.dup2(stream, number)
        os.close(stream)
    call = json.loads(text)
    os.chdir(call["folder"])
    sys.path[:2] = [os.getcwd()]
    sys.argv[1:] = call["words"]


class Forks:
    """The process that forks, begun with the first call.

    Parameters
    ----------
    environment : dict
        Of the process, and so of all calls.
    """

    def __init__(self, environment):
        self.environment, self.process, self.connection = environment, None, None

    def _begin(self):
        self.connection, other = socket.socketpair()
        code = SERVER.format(tests=os.path.dirname(__file__), number=other.fileno())
        self.process = subprocess.Popen([sys.executable, "-c", code], pass_fds=[other.fileno()],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        env=self.environment, start_new_session=True)
        other.close()

    def call(self, words, folder, seconds):
        """A finished fork that has run the command.

        Parameters
        ----------
        words : list of str
            After the command's name.
        folder : path
            In which it runs.
        seconds : float
            After which it is given up.
        """
        if self.process is None:
            self._begin()
        text = json.dumps({"words": words, "folder": str(folder)}).encode()
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
            self.connection.settimeout(seconds)
            socket.send_fds(self.connection, [text], [out.fileno(), errors.fileno()])
            try:
                status = json.loads(self.connection.recv(BYTES))
            except socket.timeout:
                os.killpg(self.process.pid, 9)
                self.end()
                raise
            for stream in (out, errors):
                stream.seek(0)
            return subprocess.CompletedProcess(words, status, out.read(), errors.read())

    def end(self):
        """End the process."""
        if self.process is not None:
            self.connection.close()
            self.process.wait()
            self.process = None
