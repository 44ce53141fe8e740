"""The machine around a run: standard streams, files and disks that fail, other processes."""
