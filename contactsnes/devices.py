"""Files and disks that fail: without a crash, and in words."""

import io
import os
import re


class Lenient(io.FileIO):
    """A new file that keeps to itself what its disk does not take: HDF5 crashes when it closes what it could not write."""

    def __init__(self, path):
        super().__init__(path, "w+")
        self._failure = None

    def write(self, data):
        """Write everything; after a failure, nothing."""
        data = memoryview(data).cast("B")
        done = 0
        while done < len(data) and not self._failure:
            try:
                done += super().write(data[done:])
            except OSError as error:
                self._failure = error
        return len(data)

    def truncate(self, size=None):
        """Change the length, unless writing has failed."""
        try:
            return size if self._failure else super().truncate(size)
        except OSError as error:
            self._failure = error
            return size

    def check(self):
        """Raise what has gone wrong."""
        if self._failure:
            raise self._failure


def reason(error):
    """Why a file cannot be used: the system's words, where HDF5 has put its own around them."""
    number = error.errno if isinstance(error, OSError) else None
    inner = re.search(r"error message = '([^']*)'", str(error))
    return inner[1] if inner else os.strerror(number) if number else str(error)
