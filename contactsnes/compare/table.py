"""A comparison of methods as rows of a table, lines of text and files: one row for each method in
each stage of the path.

A stage is the first point (cold start), or a leg of the path. Means are over the points of the
stage that a method found on the reference's branch; ratios to another method are over the points
that both found.
"""

import numpy as np

from ..grid.counter import weighed
from ..output.tables import write_csv, write_hdf5
from .comparison import CONVERGED, COUNTS, ELSEWHERE, FAILED
from .targets import ERRORS

COLUMNS = {"stage": "", "method": "", "family": "", "points": "", "found": "", "elsewhere": "",
           "failed": "", "failed_at": "", "reason": "", "transforms": "real FFTs of the cell",
           "transforms_single": "real FFTs of the cell", "function_evaluations": "",
           "jacobian_products": "", "nonlinear_iterations": "", "linear_iterations": "",
           "time": "s", "time_low": "s", "time_high": "s",
           "transforms_ratio": "", "time_ratio": "", "time_ratio_low": "", "time_ratio_high": "",
           "displacement_error": "ranges of the law", "force_error": "", "area_error": "",
           "residual_norm": "ranges of the law"}
"""Columns with their units. Counts and times are means over points, times medians over passes with
the extremes; in ratios of transforms two in single precision are one; errors and residuals are the
largest of a stage; points that a method failed at, or found another branch at, first of all
``failed_at``."""

TEXTS = ("stage", "method", "family", "failed_at", "reason")


def title(comparison, places):
    """A stage in words."""
    last = comparison.targets[places[-1]]
    if last.stage == 0:
        return f"cold start at {comparison.loads(last)}"
    return (f"leg {last.stage}, {len(places)} step{'s' * (len(places) > 1)} to "
            f"{comparison.loads(last)}")


def watched_title(comparison, place):
    """A target whose solves are watched in words."""
    target = comparison.targets[place]
    return f"{'step' if target.stage else 'cold start'} to {comparison.loads(target)}"


def rows(comparison):
    """The rows, mappings of COLUMNS, by stages and in these in the order of the methods."""
    return [_row(comparison, title(comparison, places), places, method)
            for places in comparison.stages() for method in comparison.methods]


def _row(comparison, stage, places, method):
    results, base = comparison.results[method.name], comparison.results[comparison.base]
    found = [place for place in places if results[place].outcome == CONVERGED]
    wrong = [place for place in places if results[place].outcome in (FAILED, ELSEWHERE)]
    row = dict.fromkeys(COLUMNS, np.nan) | dict.fromkeys(TEXTS, "")
    row.update(stage=stage, method=method.name, family=method.family, points=len(places),
               found=len(found), elsewhere=sum(results[place].outcome == ELSEWHERE
                                               for place in wrong),
               failed=sum(results[place].outcome == FAILED for place in wrong))
    if wrong:
        result = results[wrong[0]]
        row.update(failed_at=comparison.loads(comparison.targets[wrong[0]]), reason=result.reason
                   or result.outcome)
    if not found:
        return row
    row.update({name: float(np.mean([results[place].counts[name] for place in found]))
                for name in COUNTS})
    row.update({name: float(np.max([results[place].errors[i] for place in found]))
                for i, name in enumerate(ERRORS)})
    row["residual_norm"] = float(np.max([results[place].residual_norm for place in found]))
    row.update(_spread("time", _times(results, found) / len(found)))
    common = [place for place in found if base[place].outcome == CONVERGED]
    if common:
        row["transforms_ratio"] = float(np.divide(*(sum(weighed(of[place].counts)
                                                        for place in common)
                                                    for of in (results, base))))
        ours, theirs = _times(results, common), _times(base, common)
        passes = min(len(ours), len(theirs))
        row.update(_spread("time_ratio", ours[:passes] / theirs[:passes]))
    return row


def _times(results, places):
    """Seconds for some points together, in each pass that all of them have been timed in."""
    return np.array([sum(times) for times in zip(*(results[place].times for place in places))])


def _spread(name, values):
    """Median and extremes of a value over passes, as columns."""
    if not len(values):
        return {}
    return {name: float(np.median(values)), f"{name}_low": float(values.min()),
            f"{name}_high": float(values.max())}


# Text


def lines(comparison):
    """The table in lines for a terminal, and a line for each method that did not find every
    point."""
    table = rows(comparison)
    width = max(len(method.name) for method in comparison.methods)
    base = comparison.base
    heading = (f"  {'':{width}} {'found':>7} {'transforms':>10} {'single':>7} {'ratio':>7} "
               f"{'evaluations':>11} "
               f"{'products':>8} {'time/ms':>8} {'(least-most)':>15} {'ratio':>6} "
               f"{'(least-most)':>13} {'error: u':>8} {'force':>7} {'area':>7}")
    text = [f"Means for a point; ratios to {base}; times are medians of "
            f"{comparison.passes} passes (slow methods: one); errors are the "
            "largest: displacement in ranges of the law, force, "
            "contact area."]
    for stage in dict.fromkeys(row["stage"] for row in table):
        text += ["", stage, heading, *(_line(row, width) for row in table if row["stage"] == stage)]
    left = [comparison.verdict(method) for method in comparison.methods
            if any(result.outcome != CONVERGED for result in comparison.results[method.name])]
    if left:
        text += ["", "Points that were not found:", *(f"  {verdict}" for verdict in left)]
    if comparison.path_failure:
        text += ["", f"The path has no end: {comparison.path_failure}"]
    done = [method.name for method in comparison.methods if comparison.finished(method)]
    return [*text, "", f"{len(done)} of {len(comparison.methods)} methods finished the path"
            + (f": {', '.join(done)}" if done else "")]


def _line(row, width):
    """One row of the terminal's table."""
    found = f"{row['found']}/{row['points']}"
    if not row["found"]:
        return f"  {row['method']:{width}} {found:>7}"
    between = f"({1e3 * row['time_low']:.3g}-{1e3 * row['time_high']:.3g})"
    ratios = f"({row['time_ratio_low']:.3g}-{row['time_ratio_high']:.3g})"
    return (f"  {row['method']:{width}} {found:>7} {row['transforms']:10.1f} "
            f"{row['transforms_single']:7.1f} {row['transforms_ratio']:7.2f} "
            f"{row['function_evaluations']:11.1f} "
            f"{row['jacobian_products']:8.1f} {1e3 * row['time']:8.2f} {between:>15} "
            f"{row['time_ratio']:6.2f} {ratios:>13} {row['displacement_error']:8.0e} "
            f"{row['force_error']:7.0e} {row['area_error']:7.0e}")


# Files


def save(comparison, stem, attributes):
    """Write the table to STEM.csv, and table, results of all points and histories to STEM.h5.

    Parameters
    ----------
    comparison : Comparison
    stem : path without suffix
    attributes : mapping, attributes of the root of STEM.h5
    """
    table = rows(comparison)
    write_csv(f"{stem}.csv", COLUMNS, table)
    write_hdf5(f"{stem}.h5", {"format": "contactsnes comparison 1", "name": comparison.name,
                              "base": comparison.base, "passes": comparison.passes,
                              "path_failure": comparison.path_failure, **attributes},
               _content(comparison, table))


def _content(comparison, table):
    """What a file keeps of a comparison, as nested mappings, and of its table."""
    targets, methods = comparison.targets, comparison.methods
    results = [comparison.results[method.name] for method in methods]
    return {"table": {name: ([row[name] for row in table], unit)
                      for name, unit in COLUMNS.items()},
            "methods": {"name": [method.name for method in methods],
                        "family": [method.family for method in methods],
                        "options": ["\n".join(f"-{name} {value}".strip()
                                              for name, value in method.entries.items())
                                    for method in methods]},
            "points": {"stage": [target.stage for target in targets],
                       "load": [comparison.loads(target) for target in targets],
                       "residual_norm": ([target.point.residual_norm for target in targets],
                                         "ranges of the law")},
            "results": _results(results),
            "histories": {str(place): {"title": watched_title(comparison, place),
                                       **{str(number): line[place].history()
                                          for number, line in enumerate(results)
                                          if line[place].histories}}
                          for place in comparison.watched}}


def _results(results):
    """Arrays (methods, points) of what became of them, counts, errors and times."""
    def everywhere(value):
        return [[value(result) for result in line] for line in results]

    return {"outcome": everywhere(lambda result: result.outcome),
            "reason": everywhere(lambda result: result.reason),
            **{name: everywhere(lambda result, name=name: result.counts.get(name, -1))
               for name in COUNTS},
            **{name: everywhere(lambda result, i=i: result.errors[i])
               for i, name in enumerate(ERRORS)},
            "time": (_padded([[result.times for result in line] for line in results]), "s")}


def _padded(times):
    """Array (methods, points, passes) of seconds; what was not timed is NaN."""
    longest = max((len(passes) for line in times for passes in line), default=0)
    return [[[*passes, *[np.nan] * (longest - len(passes))] for passes in line] for line in times]
