"""Programs of Python as forks of a process that has imported what they import: MPI's launcher
starts a small program in the place of each, which hands over its arguments, folder, environment and
streams, and ends as the fork does, or takes it along. Importing takes longer than most of them.

As a program, ``forks.py -serve PATH MODULES...`` starts forks for whoever asks at a socket, until
its standard input ends; ``forks.py PATH ARGUMENTS...`` is in the place of Python with these
arguments.
"""

import json
import os
import socket
import sys


def stand_in(path, arguments):
    """The exit status of a fork of the process at a socket, which Python's arguments are for."""
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(path)
        order = json.dumps([arguments, os.getcwd(), dict(os.environ)]).encode()
        socket.send_fds(server, [len(order).to_bytes(8, "big")], [0, 1, 2])
        server.sendall(order)
        return int(server.recv(16) or b"1")  # nothing comes of one that is killed


def serve(path):
    """Start forks as they are asked for; in each, the connection with its stand-in, what it has to
    do, and its streams."""
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(path)
        listener.listen(64)
        print("ready", flush=True)
        while listener in select.select([listener, 0], [], [])[0]:
            asking, _ = listener.accept()
            if os.fork() == 0:
                size, files, *_ = socket.recv_fds(asking, 8, 3)
                with asking.makefile("rb") as rest:
                    order = rest.read(int.from_bytes(size, "big"))
                return asking, json.loads(order), files
            asking.close()
    return None


def become(asking, order, files):
    """Do in this process what a stand-in was started for, and tell it the exit status.

    Parameters
    ----------
    asking : socket
    order : (arguments of Python, folder, environment)
    files : standard streams, as numbers
    """
    for stream, file in enumerate(files):
        os.dup2(file, stream)
        os.close(file)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    # where the stand-in is killed, the system ends this process, too
    fcntl.fcntl(asking, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(asking, fcntl.F_SETFL, fcntl.fcntl(asking, fcntl.F_GETFL) | os.O_ASYNC)
    arguments, folder, variables = order
    os.environ.clear()
    os.environ.update(variables)
    gc.enable()
    status = status_of(arguments, folder)
    starter.close()
    if "mpi4py.MPI" in sys.modules and not sys.modules["mpi4py.MPI"].Is_finalized():
        sys.modules["mpi4py.MPI"].Finalize()
    asking.sendall(str(status).encode())
    os._exit(status)


def status_of(arguments, folder):
    """The exit status of a program of Python that runs in this process."""
    try:
        if arguments[0] == "-c":
            os.chdir(folder)
            sys.argv, sys.path[0] = ["-c", *arguments[2:]], ""
            main = sys.modules["__main__"] = ModuleType("__main__")
            exec(compile(arguments[1], "<string>", "exec"), vars(main))
        else:
            starter.follow(arguments, folder)
    except SystemExit as end:
        if isinstance(end.code, (int, type(None))):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException:
        sys.excepthook(*sys.exc_info())
        return 1
    return 0


if __name__ == "__main__":
    if sys.argv[1] != "-serve":
        os._exit(stand_in(sys.argv[1], sys.argv[2:]))
    import fcntl
    import gc
    import select
    import signal
    from pathlib import Path
    from types import ModuleType

    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "paper"))
    import starter

    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for forks here
    starter.prepare(sys.argv[3:])
    asked = serve(sys.argv[2])
    if asked is not None:
        become(*asked)
