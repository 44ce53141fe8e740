"""The law of a scene: one of a file of one's own, an object in place of it, and options of
others."""

import dataclasses

from ..interface import laws, own_laws
from ..options.fields import InputError, extend

ALWAYS_KEPT = {"residual_friction", "residual_adhesion"}
"""Options of a law that archives tell of whatever the law, since the first ones did."""


def with_law(scene, law):
    """The scene of a law that is given as an object: by its name and options, where it is one of
    those that have one."""
    if type(law) is laws.LAWS.get(law.name):
        return dataclasses.replace(scene, law=law.name,
                                   **{name: getattr(law, name) for name in law.declared()})
    return dataclasses.replace(scene, law=laws.keep(law))


def admit(cls, name):
    """Load the law that a name may have in a file of one's own, and give the class of scenes its
    options.

    The name; InputError where the law or an option of it cannot be had.
    """
    if own_laws.is_own(name) and name not in laws.OWN:
        law = own_laws.load(name)
        try:
            extend(cls, law.declared())
            laws.enter(name, law)
        except TypeError as error:
            raise InputError(
                f"-scene_law is '{name}', but {error}: give its option another name") from None
    return name


def check(scene):
    """InputError where a law of one's own has another tangent than its tractions; each is looked at
    once."""
    law = laws.of(scene)
    if scene.law in laws.OWN and not vars(law).get("_looked_at"):
        own_laws.check(law, scene.law)
        law._looked_at = True


def untold(scene):
    """Options of other laws, of which an archive of the scene does not tell."""
    return set(laws.OPTIONS) - set(laws.named(scene.law).declared()) - ALWAYS_KEPT


def ineffective(scene, sheared):
    """(option, whether it changes nothing, why) for the options of laws, some of which matter where
    there is slip only."""
    law = laws.named(scene.law)
    return (*((f"scene_{name}", name not in law.declared(), f"the law {scene.law} has none")
              for name in laws.OPTIONS),
            *((f"scene_{name}", not sheared, "no tangential unknown appears")
              for name in law.slip_options))
