"""The law, the shape and the body of a scene: those of files of one's own, objects in place of
them, and options of others."""

import dataclasses
import reprlib
import warnings

from ..interface import (
    bodies,
    laws,
    own_bodies,
    own_files,
    own_laws,
    own_methods,
    own_shapes,
    shapes,
)
from ..options.arguments import of_class, unfit
from ..options.fields import InputError, as_text, extend

REGISTRIES = (laws.REGISTRY, shapes.REGISTRY, bodies.REGISTRY)

ALWAYS_KEPT = {"residual_friction", "residual_adhesion"}
"""Options of a law that archives tell of whatever the law, since the first ones did."""


def with_parts(scene, law=None, geometry=None, body=None):
    """The scene with objects in place of its law, shape or body: by name and options, where they
    are of those that have a name.

    Parameters
    ----------
    scene : Scene
    law : Law, optional
    geometry : Shape, or a function of the coordinates (`own_shapes.Plain`), optional
    body : Body, optional

    Returns
    -------
    Scene
    """
    if geometry is not None and not isinstance(geometry, shapes.Shape):
        if isinstance(geometry, type) or not callable(geometry):
            raise unfit("the geometry", geometry, "a function of the coordinates, or an object of "
                        "a subclass of contactsnes.Shape")
        geometry = own_shapes.plain(geometry)
    for registry, made in zip(REGISTRIES, (law, geometry, body)):
        if made is None:
            continue
        of_class(f"the {registry.kind}", made, registry.base,
                 f"an object of a subclass of contactsnes.{registry.base.__name__}")
        if type(made) is registry.found.get(made.name):
            values = {registry.field: made.name,
                      **{name: getattr(made, name) for name in made.declared()}}
        else:
            own_methods.check(registry, f"the {registry.kind} is {reprlib.repr(made)}", made)
            values = {registry.field: registry.keep(made)}
        if any(getattr(scene, name) != value for name, value in values.items()):
            scene = dataclasses.replace(scene, **values)
    return scene


def for_branch(scene, law=None, geometry=None, body=None):
    """As `with_parts`, with a law of one's own looked at, and a warning of files that have
    changed.

    Parameters
    ----------
    scene, law, geometry, body : as of `with_parts`
    """
    scene = with_parts(scene, law, geometry, body)
    check_law(scene)
    _warn_of_stale(scene)
    return scene


def _warn_of_stale(scene):
    """Warn of files of one's own, of those that a scene names, that have changed since this program
    read them: what they said then is what is computed with."""
    for registry in REGISTRIES:
        name = getattr(scene, registry.field)
        if name in registry.own and own_files.is_stale(name, registry.own[name]):
            warnings.warn(f"-scene_{registry.field} is '{name}': the file has changed since this "
                          "program read it, and what it said then is used; start Python anew, or "
                          f"give an object in its place ({registry.field}=)", stacklevel=4)


def admit(cls, values):
    """Load the law, shape and body that options may name in files of one's own, and give the class
    of scenes their options.

    Parameters
    ----------
    cls : Scene
    values : mapping of the fields of scenes, among others, to what they are given as

    Raises
    ------
    InputError : where one, or an option of it, cannot be had
    """
    for registry in REGISTRIES:
        name = values.get(registry.field) or ""
        if not isinstance(name, str) or not own_files.is_own(name) or registry.knows(name):
            continue
        made = own_files.load(registry, name, own_shapes.plain if registry is shapes.REGISTRY
                              else None)
        own_methods.check(registry, f"-scene_{registry.field} is '{name}'", made)
        try:
            extend(cls, made.declared() if isinstance(made, type) else {})
            registry.enter(name, made)
        except TypeError as error:
            raise InputError(f"-scene_{registry.field} is '{name}', but {error}: give its option "
                             "another name") from None


def completed(cls, values):
    """Values of a scene's options as they are typed, with what its shape adds to them: a map of
    heights its size and points.

    Parameters
    ----------
    cls : Scene
    values : mapping of options that are given
    """
    made = shapes.named(values.get("geometry") or cls.rule("geometry")["default_text"])
    return made.completed(values, cls) if made is not None else values


def check_law(scene):
    """InputError where a scene's law is one's own and not what laws are; each is looked at once."""
    law = laws.of(scene)
    if laws.REGISTRY.knows(scene.law) and not vars(law).get("_looked_at"):
        own_laws.check(law, scene.law, in_file=scene.law in laws.REGISTRY.own)
        vars(law)["_looked_at"] = True  # (set as options are, it would end what watches the law)


def check(scene):
    """InputError where a law in a file is not what laws are, or where shape or body do not suit the
    scene."""
    if scene.law in laws.REGISTRY.own:
        check_law(scene)
    own_shapes.check_declared(shapes.of(scene), scene)
    shapes.of(scene).check(scene)
    own_bodies.check_own(bodies.of(scene), scene)
    bodies.of(scene).check(scene)


def blamed(error):
    """A sentence on an error out of a file of one's own (`own_methods.blamed`)."""
    return own_methods.blamed(error, REGISTRIES)


def sources(scene):
    """Name -> SHA-256 of the files of one's own that a scene is made of."""
    made = {registry.field: registry.of(scene) for registry in REGISTRIES}
    return {f"{field}_sha256": part.source_sha256 for field, part in made.items()
            if hasattr(part, "source_sha256")}


def peaks(scene):
    """Largest attraction and friction of a scene's law, phi_n/delta_n and phi_t/delta_t."""
    law = laws.of(scene)
    return law.normal_peak, law.tangential_peak


def about_law(scene):
    """Phrases on the options of a scene's law: one, or none where it has none."""
    declared = laws.named(scene.law).declared()
    return [", ".join(f"{name.replace('_', ' ')} {as_text(scene.as_typed(name))}"
                      for name in declared)] if declared else []


def _declared(registry, scene):
    """Options of what a scene names, a set."""
    made = registry.named(getattr(scene, registry.field))
    return set(made.declared()) if isinstance(made, type) else set()


def untold(scene):
    """Options of other laws, shapes and bodies, of which an archive of the scene does not tell."""
    own = set().union(*(_declared(registry, scene) for registry in REGISTRIES))
    others = set().union(*(registry.options for registry in REGISTRIES))
    return others - own - ALWAYS_KEPT


def ineffective(scene, sheared):
    """(option, whether it changes nothing, why) for the options of laws, shapes and bodies, some of
    which matter where there is slip only."""
    rules = []
    for registry, why in zip(REGISTRIES, ("the law {} has none", "the geometry is {}",
                                          "the body {} has none")):
        own = _declared(registry, scene)
        reason = why.format(getattr(scene, registry.field))
        rules += [(f"scene_{name}", name not in own, reason) for name in registry.options]
    slip = laws.named(scene.law).slip_options
    return (*rules, *((f"scene_{name}", not sheared, "no tangential unknown appears")
                      for name in slip))
