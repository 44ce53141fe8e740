"""The commands, their words and exit status."""
