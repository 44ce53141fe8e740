"""Programs of Python as forks of a process that has imported what they import: MPI's launcher
starts a small program in the place of each, which hands over its arguments, folder, environment and
streams, and ends as the fork does, or takes it along. Importing takes longer than most of them.

A stand-in keeps the only end of a pipe that can be written to: nobody writes, and the end of the
stand-in, of which the system sends a signal, is all that ever comes. Such a signal of the socket
would come of what is sent, too: the system wakes who waits for it first, and sends it afterwards.

As a program, ``forks.py -serve PATH MODULES...`` starts forks for whoever asks at a socket, until
its standard input ends; ``forks.py PATH ARGUMENTS...`` is in the place of Python with these
arguments.
"""

import json
import os
import socket
import sys


def stand_in(path, arguments):
    """The exit status of a fork of the process at a socket, which Python's arguments are for; where
    a signal ends it, which is told, that of a shell."""
    ended, _kept = os.pipe()
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(path)
        order = json.dumps([arguments, os.getcwd(), dict(os.environ)]).encode()
        socket.send_fds(server, [len(order).to_bytes(8, "big")], [0, 1, 2, ended])
        server.sendall(order)
        status = server.recv(16)
    if not status:
        print("forks.py: what starts forks is gone", file=sys.stderr)
        return 1
    if int(status) < 0:
        print(f"forks.py: signal {-int(status)} has ended a fork", file=sys.stderr)
        return 128 - int(status)
    return int(status)


def serve(path):
    """Start forks as they are asked for, and tell how each has ended; in each, what it has to do,
    and files: its streams, and what can be read when its stand-in has ended."""
    running = {}  # file of a process -> (its number, who asks for it)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(path)
        listener.listen(64)
        print("ready", flush=True)
        while 0 not in (ready := select.select([listener, 0, *running], [], [])[0]):
            for file in running.keys() & ready:
                tell_end(file, *running.pop(file))
            if listener in ready:
                asking, _ = listener.accept()
                number = os.fork()
                if number == 0:
                    size, files, *_ = socket.recv_fds(asking, 8, 4)
                    with asking.makefile("rb") as rest:
                        order = rest.read(int.from_bytes(size, "big"))
                    return json.loads(order), files
                running[os.pidfd_open(number)] = number, asking
    return None


def tell_end(file, number, asking):
    """Tell who asked for a process how it has ended.

    Parameters
    ----------
    file, number : of the process
    asking : socket
    """
    os.close(file)
    status = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
    with asking, suppress(OSError):  # who asked may be gone
        asking.sendall(str(status).encode())


def become(order, files):
    """Do in this process what a stand-in was started for, and end.

    Parameters
    ----------
    order : (arguments of Python, folder, environment)
    files : numbers of the standard streams, and of what can be read when the stand-in has ended
    """
    *streams, stand_in_ended = files
    for stream, file in enumerate(streams):
        os.dup2(file, stream)
        os.close(file)
    fcntl.fcntl(stand_in_ended, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(stand_in_ended, fcntl.F_SETFL, os.O_ASYNC)  # from now on SIGIO, which ends this one
    if select.select([stand_in_ended], [], [], 0)[0]:
        os._exit(1)
    arguments, folder, variables = order
    os.environ.clear()
    os.environ.update(variables)
    gc.enable()
    status = status_of(arguments, folder)
    starter.close()
    if "mpi4py.MPI" in sys.modules and not sys.modules["mpi4py.MPI"].Is_finalized():
        sys.modules["mpi4py.MPI"].Finalize()
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
    from contextlib import suppress
    from pathlib import Path
    from types import ModuleType

    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts" / "paper"))
    import starter

    starter.prepare(sys.argv[3:])
    asked = serve(sys.argv[2])
    if asked is not None:
        become(*asked)
