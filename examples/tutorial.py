"""A tutorial in cells: from numbers of an experiment to curves, a table and a page to look at.

Editors as Spyder, VS Code and PyCharm run it cell by cell (each begins with # %%);
python examples/tutorial.py [FOLDER] runs it whole, into FOLDER or results/tutorial.
"""

# %% A cylinder of silicone rubber on glass, in SI: works of adhesion, modulus, radius, ranges.
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contactsnes import Branch, InputError, Load, Scene, plot, reference, sweep

given = sys.argv[1:] if Path(sys.argv[0]).name == "tutorial.py" else []
if {"-h", "--help"} & {*given}:
    sys.exit(print(__doc__))
folder = Path(given[0] if given else "results/tutorial")
folder.mkdir(parents=True, exist_ok=True)

rubber = Scene.typed(units="si", work_of_adhesion_normal=0.03, work_of_adhesion_tangential=0.03,
                     contact_modulus=2e6, radius=0.01, range_normal=0.8e-6, range_tangential=1e-6,
                     residual_friction=0.5, period=6e-3, height=0.1, points=512)
print(rubber)

# %% What is that in the model's own numbers? The Maugis parameters say how short-ranged it is.
print(f"Maugis parameters: normal {rubber.normal_maugis:.2f}, "
      f"tangential {rubber.tangential_maugis:.2f}")

# %% Press it by 5 N/m, and pull it off. Points come as they are found, and say what they are.
pull = Branch(rubber, Load(path="normal_force=5; normal_displacement=-2e-5", stop="pull_off"))
found = []
for point in pull:
    found.append(pull.observe(point))
    if point.event:
        print(point)

# %% Numbers are in SI, as the scene is. How near is the theory of Maugis and Dugdale?
strongest = min(numbers["normal_force"] for numbers in found)
unit = rubber.scale("w_n,r")[0]  # N/m
theory = unit * reference.maugis_line_pull_off(rubber.normal_maugis, rubber.periods[0])[0]
print(f"pull-off at {strongest:.4f} N/m, by Maugis and Dugdale at {theory:.4f} N/m")

# %% A study: the same body sheared, with three kinds of friction. Runs go on where they were left.
load = Load(path="normal_force=5; tangential_displacement=8e-4", stop="gross_sliding")
study = sweep(rubber, load, folder=folder / "runs", fields="all",
              residual_friction=[0.2, 0.5, 1.0])
print(study)

# %% Each run is an archive, which says what it holds; columns are arrays.
for friction, record in study.items():
    print(friction, record)
peaks = study.take("tangential_force", max)

# %% One's own figure
axes = Figure(layout="constrained").subplots()
for friction, record in study.items():
    axes.plot(record["tangential_force"], 1e3 * record["contact_area"], label=f"{friction:g}")
axes.set(xlabel="tangential force (N/m)", ylabel="contact length (mm)")
axes.legend(title="residual friction")
axes.figure.savefig(folder / "own.png")

# %% The program's figures, of all runs together
figures = plot([record.path for record in study.values()], output=folder, together="study")
print([path.name for path in figures.files])

# %% Back from the middle of a run: the law has no memory, so that the area comes back.
record = study[1.0]
middle = int(np.argmax(record["tangential_force"] > 0.5 * peaks[-1]))
back = Branch.restart(record, "tangential_displacement=0", middle)
*_, last = back
area = back.observe(last)["contact_area"]
print(f"{1e3 * record['contact_area'][middle]:.4f} mm -> {1e3 * area:.4f} mm, "
      f"before the shear {1e3 * record['contact_area'].max():.4f} mm")

# %% Tables and a page need libraries of the extras [table] and [report].
try:
    print(record.to_dataframe()[["tangential_force", "contact_area", "event"]].tail())
except InputError as error:
    print(error)
print(f"contactsnes report {record.path}    # a page with all of it")
