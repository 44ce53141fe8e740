"""h5py, imported while signals wait: interrupted between its first word to HDF5 and its order to be
told of the program's end, it leaves HDF5 to call an interpreter that has ended."""

from .streams import Waiting

with Waiting():
    import h5py as h5py
