"""The table of a campaign: how many of each outcome, from the rows of its parts."""

import csv
from collections import Counter, defaultdict
from pathlib import Path

from contactsnes.output.tables import markdown, write_between

from . import faults, judge

BEGIN = "<!-- scripts/campaign writes from here -->\n"
END = "<!-- scripts/campaign: as far as here -->\n"
SHORT = {"agreed": "as it should be", "unresolved": "differs, told by `resolved`",
         "unstable": "differs, told by `stable`", "said": "no equilibrium, named",
         "failed": "failed, named", "some": "failed in some variants", "refused": "refused",
         "time": "out of time", "silent": "wrong without a word", "crashed": "crashed"}


def rows(results):
    """Rows of all parts, name of the part -> list."""
    found = defaultdict(list)
    for path in sorted(Path(results).glob("campaign-*.csv")):
        with open(path, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                found[row["part"]].append(row)
    return found


def lines(results):
    """The table in Markdown, and how much was computed for it."""
    heading = ["", "cases", "runs", *SHORT.values()]
    counted = []
    found = rows(results)
    sources = found.pop("faults", [])
    for part, own in found.items():
        own = {row["number"]: row for row in own}.values()
        counts = Counter(row["outcome"] for row in own)
        counted.append([part, str(len(own)), str(sum(int(row["runs"] or 0) for row in own)),
                        *(str(counts[name]) for name in SHORT)])
    return [*markdown(heading, counted), *fault_lines(sources)]


def fault_lines(rows):
    """How many of the faults planted in the sources were found, by what they are about; nothing
    where none were planted."""
    own, listed = {int(row["number"]): row["outcome"] for row in rows}, faults.read_faults()
    planted = Counter(fault.area for number, fault in enumerate(listed) if number in own)
    found = Counter(fault.area for number, fault in enumerate(listed)
                    if own.get(number) == "agreed")
    counts = [[area, str(planted[area]), str(found[area])] for area in planted]
    total = [["all", str(sum(planted.values())), str(sum(found.values()))]]
    return ["", *markdown(["faults in the sources", "planted", "found by the tests"],
                          [*counts, *total])] if own else []


def write(results, path):
    """Put the table between its marks in a page."""
    try:
        write_between(path, BEGIN, END, "\n".join(lines(results)) + "\n")
    except ValueError as error:
        print(f"{error}: the table is not written there")


def lost(results):
    """Whether the tests did not find more than one in twenty of the faults planted in the
    sources."""
    outcomes = list({row["number"]: row["outcome"] for row in rows(results)["faults"]}.values())
    return len(outcomes) - outcomes.count("agreed") > 0.05 * len(outcomes)


def failed(results, parts):
    """Whether an outcome of some parts is forbidden."""
    found = rows(results)
    return any(row["outcome"] in judge.FORBIDDEN for part in parts
               for row in {row["number"]: row for row in found[part]}.values())
