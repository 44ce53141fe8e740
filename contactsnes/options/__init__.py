"""Options: fields of dataclasses, files of options, and PETSc's database."""
