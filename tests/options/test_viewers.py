"""Files that PETSc's options have it write."""

import pytest

from contactsnes.options.fields import InputError
from contactsnes.options.solver_values import refuse_unwritable


@pytest.mark.parametrize("name, text", [
    ("log_view", ":absent/told.txt"), ("snes_monitor", "ascii:absent/told.txt:ascii_info"),
    ("npc_ksp_view_mat", "binary:absent/told"), ("snes_converged_reason", ":."),
    ("ksp_converged_rate", ":absent/told.txt")])
def test_a_file_in_no_folder_is_refused(name, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=f"-{name} is '{text}'.*cannot be written"):
        refuse_unwritable({"snes_atol": "1e-9", name: text})


def test_what_can_be_written_is_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refuse_unwritable({"log_view": ":told.txt", "snes_monitor": "", "snes_view": "::ascii_info",
                       "ksp_view": f"ascii:{tmp_path}/told.txt", "ksp_monitor": "draw:absent/none",
                       "scene_law": "absent/law.py:Law", "snes_view_solution": "draw"})
