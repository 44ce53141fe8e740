"""Traction-separation laws, each a class in a file of this folder, where it is found: a new file
suffices."""

from ..declared import Registry
from .law import Law

REGISTRY = Registry("law", "law", Law, __package__, __file__)
LAWS, OPTIONS = REGISTRY.found, REGISTRY.options
of, named, keep = REGISTRY.of, REGISTRY.named, REGISTRY.keep
