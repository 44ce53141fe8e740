"""Forks in the place of fresh processes: what they are given, and how they end."""

import os
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


@together
def test_a_fork_ends_with_its_stand_in(tmp_path):
    if len(interpreter()) == 1:
        pytest.skip("no forks here")
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
