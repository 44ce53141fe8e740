"""Files that PETSc's options have it write."""

import pytest

from contactsnes.options.fields import InputError
from contactsnes.options.solver_values import refuse_unwritable


@pytest.mark.parametrize("name, text", [
    ("log_view", ":absent/told.txt"), ("snes_monitor", "ascii:absent/told.txt:ascii_info"),
    ("npc_ksp_view_mat", "binary:absent/told"), ("snes_converged_reason", ":."),
    ("ksp_converged_rate", ":absent/told.txt"), ("history", "absent/told"),
    ("citations", "absent/told"), ("log_trace", "absent/told"), ("info", "absent/told:snes")])
def test_a_file_in_no_folder_is_refused(name, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=f"-{name} is '{text}'.*cannot be written"):
        refuse_unwritable({"snes_atol": "1e-9", name: text})


def test_a_log_that_is_no_file_is_refused():
    """PETSc would say so when all is done."""
    with pytest.raises(InputError, match="-log_view is 'log.txt': allowed is :FILE"):
        refuse_unwritable({"log_view": "log.txt"})


def test_what_can_be_written_is_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refuse_unwritable({"log_view": ":told.txt", "snes_monitor": "", "snes_view": "::ascii_info",
                       "ksp_view": f"ascii:{tmp_path}/told.txt", "ksp_monitor": "draw:absent/none",
                       "history": "", "info": ":snes", "citations": "told.bib",
                       "scene_law": "absent/law.py:Law", "snes_view_solution": "draw"})
