"""What a report says of how far an archive can be trusted."""

import html

import numpy as np

from .words import loads, number, symbol

MISSING = 0.002
"""Part of the largest work that the balance of energies may miss without a mark, as where a run
ends."""


def rows(record):
    """Certificates: [what, value, whether it is fine], values as HTML."""
    worst, unresolved = float(np.max(record["residual_norm"])), _count(record["resolved"] == 0)
    found = [["the path was followed to its end", "yes" if record.complete else "no",
              bool(record.complete)],
             ["largest residual_norm, ranges of the law", number(worst, 2), worst < 1e-6],
             ["points that the grid does not resolve", str(unresolved), not unresolved],
             _balance(record), *_stability(record), *_errors(record)]
    return found


def _balance(record):
    """What the balance of energies leaves, of the points before a jump whose loss is not known."""
    told, tested = "missing in the balance of energies", np.isfinite(record["energy_imbalance"])
    done = record["external_work"]
    if np.isnan(done).all():  # loads of a half-plane do a work that is not known
        done = record["interface_work"]
    missing, work = (float(np.nanmax(np.abs(values[tested]), initial=0.0))
                     for values in (record["energy_imbalance"], done))
    text = f"{number(missing, 2)} of {number(work, 3)} {symbol(record.units['external_work'])}"
    if not tested.all():
        text += f", of the {_count(tested)} points before a jump whose loss is not known"
    return [told, text, missing <= MISSING * work or work == 0.0]


def _count(mask):
    return int(np.count_nonzero(mask))


def _stability(record):
    """Whether points were found to be stable."""
    stable, unstable = (_count(record["stable"] == value) for value in (1, 0))
    unknown = record.points - stable - unstable
    told = [f"{stable} stable", f"{unstable} unstable", f"{unknown} not checked"]
    return [["stability of points", ", ".join(told), not unstable]]


def _errors(record):
    """Estimates of errors, where they were asked for."""
    return [[f"largest {name.replace('_', ' ')}, relative",
             number(float(np.nanmax(record[name], initial=0.0)), 2), True]
            for name in ("error_normal_force", "error_contact_area", "error_slip",
                         "error_tangential_force")
            if name in record]


def events(record):
    """Events: number of the point, name and kind, loads, precision of folds; as HTML."""
    found = []
    for point in np.flatnonzero(record["event"] != "none"):
        kind = str(record["fold_kind"][point])
        name = str(record["event"][point]) + (f" ({kind})" if kind else "")
        precision = float(record["fold_precision"][point])
        found.append([str(point), html.escape(name.replace("_", " ")), loads(record, point),
                      number(precision, 2) if precision else ""])
    return found
