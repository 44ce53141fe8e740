"""Forks in the place of fresh processes: what they are given, and how they end."""

import json
import os
import socket
import subprocess
import time

import pytest
from ranks import environment, interpreter, together

SAYING = """
import os, sys
print(os.getcwd(), os.environ["NAME"], sys.argv, __name__)
{end}"""


@together
@pytest.mark.parametrize("end, status, complaint", [
    ("", 0, ""), ("sys.exit(3)", 3, ""), ("sys.exit('no')", 1, "no"),
    ("raise ValueError('of mine')", 1, "ValueError: of mine"),
    ("sys.stdout.flush(); os.abort()", None, "")])
def test_forks_end_as_programs_do(end, status, complaint, tmp_path):
    done = subprocess.run([*interpreter(), "-c", SAYING.format(end=end)], cwd=tmp_path, text=True,
                          env=environment() | {"NAME": "value"}, capture_output=True, check=False)
    assert complaint in done.stderr, done
    assert done.returncode == status if status is not None else done.returncode, done
    assert done.stdout.split() == [str(tmp_path), "value", "['-c']", "__main__"]


def skip_without_forks():
    if len(interpreter()) == 1:
        pytest.skip("no forks here")


@together
def test_a_fork_ends_with_its_stand_in(tmp_path):
    skip_without_forks()
    text = "import os, time; open('number', 'w').write(f'{os.getpid()} '); time.sleep(600.0)"
    stand_in = subprocess.Popen([*interpreter(), "-c", text], cwd=tmp_path, env=environment())
    path = tmp_path / "number"
    while not (path.exists() and path.read_text().endswith(" ")):
        time.sleep(0.01)
    fork = int(path.read_text())
    assert fork != stand_in.pid
    stand_in.kill()
    stand_in.wait()
    until = time.monotonic() + 60.0
    while time.monotonic() < until and os.path.exists(f"/proc/{fork}"):
        time.sleep(0.01)
    assert not os.path.exists(f"/proc/{fork}")


@together
def test_no_fork_ends_by_what_is_sent_to_it(tmp_path):
    """The system wakes a fork when all has come, and signals that later, if it is kept from going
    on: so does it of one byte more."""
    skip_without_forks()
    text = "import time; open('begun', 'w').close(); time.sleep(0.1)"
    order = json.dumps([["-c", text], str(tmp_path), environment()]).encode()
    ended, kept = os.pipe()
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(interpreter()[-1])
        socket.send_fds(server, [len(order).to_bytes(8, "big")], [0, 1, 2, ended])
        server.sendall(order)
        while not (tmp_path / "begun").exists():
            time.sleep(0.01)
        server.sendall(b"more")
        assert server.recv(16) == b"0"
    os.close(ended)
    os.close(kept)
