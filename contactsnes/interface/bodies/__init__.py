"""Elastic bodies, each a class in a file of this folder, where it is found: a new file suffices."""

from ..declared import Registry
from .body import Body

REGISTRY = Registry("body", "body", Body, __package__, __file__)
BODIES = REGISTRY.found
named = REGISTRY.named


def of(scene):
    """The body that a scene names, with the scene's values of its options and its ratio of
    works."""
    return REGISTRY.of(scene).with_work_ratio(scene.work_ratio)
