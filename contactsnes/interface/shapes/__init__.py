"""Shapes of the gap, each a class in a file of this folder, where it is found: a new file
suffices."""

from ..declared import Registry
from .shape import Shape

REGISTRY = Registry("shape", "geometry", Shape, __name__, __path__)
SHAPES = REGISTRY.found
of, named = REGISTRY.of, REGISTRY.named
