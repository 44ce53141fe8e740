"""The archive of a run in several processes: the first one has the file."""

from ..system.processes import world

NODAL = ("displacement", "window_nodes")
"""Of a state what has an entry a node: large."""


class SharedArchive:
    """An archive that the first process keeps, with what a run asks of an `archive.Archive`; what
    goes wrong there is raised in all.

    Parameters
    ----------
    make : function without arguments that returns the Archive; arrays of what it is to hold are
        parted, as those of points are
    grid : Grid, whose first process takes parts of arrays from the others

    Attributes
    ----------
    points, complete, lacking, path, runs : as of an Archive
    """

    def __init__(self, make, grid):
        self._kept, self._grid = None, grid
        self._make = make  # what it holds the first process may ask for at any time

        def keep():
            self._kept = make()

        self._in_first(keep)

    def append(self, *point, **active):
        """Add a point: `Archive.append`."""
        self._in_first(lambda: self._kept.append(*point, **active))

    def settle(self):
        """Write what waits: `Archive.settle`."""
        self._in_first(lambda: self._kept.settle())

    def finish(self):
        """Mark the archive as complete: `Archive.finish`."""
        self._in_first(lambda: self._kept.finish())

    def remove(self):
        """Remove the file: `Archive.remove`."""
        self._in_first(lambda: self._kept.remove())

    def states(self):
        """States of the last points, `Archive.states`: what is of each node in the first process,
        None in the others."""
        kept = []

        def told():
            kept.extend(self._kept.states())
            return [{name: None if name in NODAL else value for name, value in state.items()}
                    for state in kept]

        states = world.first(told)
        return kept or states

    def _in_first(self, act):
        """Act in the first process; what has come of the archive is known to all, after a failure
        as well: what waits in the journal survives it."""
        def acted():
            error = None
            try:
                self._grid.taking(act)
            except Exception as raised:
                if self._kept is None:
                    raise
                error = raised
            kept = self._kept
            return error, (kept.points, kept.complete, kept.lacking, kept.path, kept.runs)

        if world.rank:
            self._grid.taking(act)
        error, known = world.first(acted)
        self.points, self.complete, self.lacking, self.path, self.runs = known
        if error is not None:
            raise error
