"""Shapes of the gap, each a class in a file of this folder, where it is found: a new file
suffices."""

from ..declared import Registry
from .shape import Shape

REGISTRY = Registry("shape", "geometry", Shape, __package__, __file__)
SHAPES = REGISTRY.found
of, named = REGISTRY.of, REGISTRY.named
