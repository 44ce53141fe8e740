"""The table of a campaign: how many of each outcome, from the rows of its parts."""

import csv
from collections import Counter, defaultdict
from pathlib import Path

from . import judge

BEGIN, END = "<!-- scripts/campaign writes from here -->\n", "<!-- scripts/campaign: as far as here -->\n"
SHORT = {"agreed": "as it should be", "unresolved": "differs, told by `resolved`", "unstable": "differs, told by `stable`",
         "said": "no equilibrium, named", "failed": "failed, named", "some": "failed in some variants", "refused": "refused", "time": "out of time",
         "silent": "wrong without a word", "crashed": "crashed"}


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
    for part, own in rows(results).items():
        own = {row["number"]: row for row in own}.values()
        counts = Counter(row["outcome"] for row in own)
        counted.append([part, str(len(own)), str(sum(int(row["runs"] or 0) for row in own)), *(str(counts[name]) for name in SHORT)])
    return [f"| {' | '.join(line)} |" for line in (heading, ["---"] * len(heading), *counted)]


def write(results, path):
    """Put the table between its marks in a page."""
    content = Path(path).read_text(encoding="utf-8")
    if content.count(BEGIN) != 1 or content.count(END) != 1:
        print(f"{Path(path).name} has lost its marks: the table is not written there")
        return
    before, rest = content.split(BEGIN)
    Path(path).write_text(before + BEGIN + "\n".join(lines(results)) + "\n" + END + rest.split(END)[1], encoding="utf-8")


def lost(rows, results):
    """Write rows (name, file, found by, seconds) of faults planted in the sources; whether more than one in twenty was not found."""
    with open(Path(results) / "faults.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("name", "file", "found_by", "seconds"))
        writer.writerows(rows)
    missed = [row for row in rows if not row[2]]
    print(f"{len(rows) - len(missed)} of {len(rows)} faults were found", *(f"  not found: {row[0]} ({row[1]})" for row in missed), sep="\n")
    return len(missed) > 0.05 * len(rows)


def failed(results, parts):
    """Whether an outcome of some parts is forbidden."""
    found = rows(results)
    return any(row["outcome"] in judge.FORBIDDEN for part in parts for row in {row["number"]: row for row in found[part]}.values())
