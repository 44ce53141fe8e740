"""The law of a scene: an object in place of it, and options of others."""

import dataclasses

from ..interface import laws

ALWAYS_KEPT = {"residual_friction", "residual_adhesion"}
"""Options of a law that archives tell of whatever the law, since the first ones did."""


def with_law(scene, law):
    """The scene of a law that is given as an object: by its name and options, where it is one of those that have one."""
    if type(law) is laws.LAWS.get(law.name):
        return dataclasses.replace(scene, law=law.name, **{name: getattr(law, name) for name in law.declared()})
    return dataclasses.replace(scene, law=laws.keep(law))


def untold(scene):
    """Options of other laws, of which an archive of the scene does not tell."""
    return set(laws.OPTIONS) - set(laws.named(scene.law).declared()) - ALWAYS_KEPT


def ineffective(scene, unsheared):
    """(option, whether it changes nothing, why) for the options of laws; why ``unsheared`` where no slip appears, else None."""
    law = laws.named(scene.law)
    return (*((f"scene_{name}", name not in law.declared(), f"the law {scene.law} has none") for name in laws.OPTIONS),
            *((f"scene_{name}", unsheared is not None, unsheared) for name in law.slip_options))
