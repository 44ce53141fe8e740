"""Bodies of one's own: what they declare is looked at on the cell's waves and far shorter ones."""

from contextlib import contextmanager
from functools import partial

import numpy as np

from ..options.fields import InputError
from . import own_methods
from .bodies import BODIES
from .bodies.body import Body
from .bodies.layer import Layer
from .elasticity import Surface, layer_compliance

WAVES = 10.0 ** np.arange(0, 5, 0.5)
"""Wave numbers over that of the cell at which a body is looked at besides those of the grid."""

MANY = 2 ** 18
"""Waves of a plane's grid above which those along its axes are looked at, not all."""

ALIKE = 1e-8
"""Relative difference up to which a stiffness is the inverse of a compliance, and a body another
one."""

VANISHING = 1e-12
"""Coupling over the compliances that it couples, and relative difference of longitudinal and
transverse compliance, above which a body may not claim to have none."""

NEAR = 0.01
"""Relative difference up to which a claimed stiffness of short waves is theirs."""

SHORTEST = np.array([1e9])
"""Wave number of waves beside which no layer has a height, 1/beta."""


def check_own(body, scene):
    """InputError unless a body of one's own has finite compliances that store energy, a stiffness
    that is their inverse, and is what it claims besides."""
    if type(body) in BODIES.values():
        return
    named = f"{scene.option_name('body')} is '{scene.body}'"
    for name in Body.made:
        if getattr(type(body), name) is not getattr(Body, name):
            raise InputError(f"{named}: it has a {name} of its own, which is made of "
                             "surface(wavenumber) for every grid: declare that, and leave "
                             f"{name} out")
    q = _waves(scene)
    own_methods.check_returned(body, named, scene)
    with _evaluated(named):
        compliance, stiffness = (_untouched(body, name, q, named)
                                 for name in ("surface", "surface_stiffness"))
        _check_surface(compliance, stiffness, q, named)
        _check_each_alone(body, scene, compliance, q, named)
        _check_rigid(body, compliance, q, named)
        _check_claims(body, scene, compliance, q, named)
        for name in ("surface", "surface_stiffness"):
            vars(body)[name] = partial(_watched, body, name, named)


@contextmanager
def _evaluated(named):
    """What goes wrong inside is an InputError."""
    try:
        with np.errstate(all="ignore"):
            yield
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{named}: it cannot be evaluated ({type(error).__name__}: "
                         f"{error}); mend it") from error


def _untouched(body, name, q, named):
    """What a method of a body makes of wave numbers; InputError where it writes into these, which
    others go on with.

    Parameters
    ----------
    body : Body
    name : of the method
    q : array, wave numbers, 1/beta
    named : str
    """
    given = q.copy()
    found = getattr(type(body), name)(body, given)
    if not np.array_equal(given, q):
        raise InputError(f"{named}: its {name} writes into the wave numbers that it is "
                         "given, which others go on with: work on a copy of them")
    if not isinstance(found, Surface):
        raise InputError(f"{named}: its {name} returns a {type(found).__name__} in place of a "
                         f"Surface({', '.join(Surface._fields)}), which "
                         "contactsnes.interface.elasticity has")
    return found


def _watched(body, name, named, q):
    """What a method of a body that has been looked at makes of wave numbers, as long as it is in
    use: another grid, or a later call, may find it to be something else.

    Parameters
    ----------
    body, name, named, q : as of `_untouched`
    """
    found, of = _untouched(body, name, np.asarray(q), named), name.removeprefix("surface_")
    for words, values in zip(Surface._fields, found):
        words = f"{words} {'compliance' if of == name else of}"
        if np.shape(values) not in ((), np.shape(q)):
            raise InputError(_misshapen(named, words, values, np.asarray(q)))
        _refuse(f"{named}: its {words}", np.ravel(q), np.ravel(values),
                ~(np.isfinite(values) & np.isreal(values)).ravel(), "real and finite")
    return found


def _check_surface(c, m, q, named):
    """InputError unless compliances are real, positive and finite, and the stiffness their inverse.

    Parameters
    ----------
    c, m : Surface, compliance and stiffness
    q : array, wave numbers, 1/beta
    named : str
    """
    for words, values in zip(Surface._fields, (c.normal, c.longitudinal, c.transverse, c.coupling)):
        if np.iscomplexobj(values):
            raise InputError(f"{named}: its {words} compliance is complex: give real numbers (the "
                             "factor i between normal and tangential directions is put in later)")
    if np.shape(c.normal) != q.shape:
        raise InputError(_misshapen(named, "normal compliance", c.normal, q))
    for words, values in (("its normal compliance", c.normal),
                          ("its transverse compliance", c.transverse),
                          ("the determinant of its normal and longitudinal compliance",
                           c.normal * c.longitudinal - c.coupling ** 2)):
        _refuse(f"{named}: {words}", q, values, ~(np.isfinite(values) & (values > 0)),
                "positive and finite")
    for words, values in (
            ("normal", c.normal * m.normal - c.coupling * m.coupling),
            ("longitudinal", c.longitudinal * m.longitudinal - c.coupling * m.coupling),
            ("transverse", c.transverse * m.transverse)):
        _refuse(f"{named}: its {words} stiffness times its compliance", q, values,
                ~(np.abs(values - 1) < ALIKE), f"1 to {ALIKE:g}, as in double precision")


def _misshapen(named, words, values, q):
    """A sentence on values that are not one for each wave number.

    Parameters
    ----------
    named, words : str, of the body and of the values
    values, q : arrays
    """
    return (f"{named}: its {words} has the shape {np.shape(values)}, the wave numbers "
            f"have {q.shape}: give one value for each")


def _check_each_alone(body, scene, c, q, named):
    """InputError where a compliance hangs on more than its own wave number, or is not one for each
    of an array as the grid has it.

    Parameters
    ----------
    body : Body
    scene : Scene
    c : Surface, its compliance
    q : array, wave numbers, 1/beta
    named : str
    """
    some = q[-2::-2]
    if scene.dimension == 2:
        some = some[:len(some) // 2 * 2].reshape(2, -1)
    for words, values, others in zip(Surface._fields, body.surface(some.copy()), c):
        if np.shape(values) not in ((), some.shape):
            raise InputError(_misshapen(named, f"{words} compliance", values, some))
        values = np.broadcast_to(values, some.shape).ravel()
        others = np.broadcast_to(others, q.shape)[-2::-2][:some.size]
        _refuse(f"{named}: its {words} compliance, of fewer wave numbers in another order,",
                some.ravel(), values, ~(np.abs(values - others) <= ALIKE * np.abs(others)),
                "what it is among all of them: each hangs on its own wave number alone")


def _check_rigid(body, c, q, named):
    """InputError unless compliances of the mean surface and of the shortest waves can be those of a
    body.

    Parameters
    ----------
    body : Body
    c : Surface, its compliance
    q : array, wave numbers, 1/beta
    named : str
    """
    rigid, local = body.rigid_compliance, body.local_compliance
    normal, tangential = (float(value) for value in rigid)
    if not (0 <= normal < np.inf and 0 <= tangential < np.inf):
        raise InputError(f"{named}: its rigid_compliance is {rigid}: both have to be finite and at "
                         "least 0")
    left = [float(np.broadcast_to(part, q.shape)[-1]) for part in (c.normal, c.longitudinal)]
    if np.shape(local) != (2,) or not all(0 <= float(value) <= most * (1 + ALIKE)
                                          for value, most in zip(local, left)):
        raise InputError(f"{named}: its local_compliance is {local}: both have to "
                         f"be from 0 to what is left at short waves, at most {left[0]:.6g} "
                         f"normally and {left[1]:.6g} along the surface")


def _check_claims(body, scene, c, q, named):
    """InputError where what a body says of itself is not what its surface shows: on it depends what
    is solved for.

    Parameters
    ----------
    body : Body
    scene : Scene
    c : Surface, its compliance
    q : array, wave numbers, 1/beta
    named : str
    """
    if scene.isolated:
        _check_far_field(body, c, q, named)
    coupling = np.abs(c.coupling) / np.sqrt(c.normal * c.longitudinal) + 0 * q
    anisotropy = np.abs(c.longitudinal / c.transverse - 1) + 0 * q
    for name, claimed, seen, words in (
            ("couples", body.couples(q[0]), coupling, "coupling over its compliance"),
            ("coupled", body.coupled(scene), coupling, "coupling over its compliance"),
            ("anisotropy", scene.dimension == 1 or body.anisotropy(q[0]) > 0, anisotropy,
             "longitudinal over its transverse compliance, less 1,")):
        if not claimed:
            _refuse(f"{named}, which says that it has none by its {name}: its {words}", q, seen,
                    seen > VANISHING, f"0, or {name} = Body.{name}, which looks for it")
    _check_short_waves(body, named)


def _check_short_waves(body, named):
    """InputError where the stiffness of a body's shortest waves, behind what deforms at each place
    for itself, is not what the body says."""
    claimed, local = float(body.transverse_stiffness), body.local_compliance[1]
    if not 0 < claimed < np.inf:
        raise InputError(f"{named}: its transverse_stiffness is {claimed:.6g}: it has to be "
                         "positive and finite")
    if type(body).transverse_stiffness is not Body.transverse_stiffness:
        c = body.surface(SHORTEST)
        seen = float(((c.longitudinal - local) / (c.transverse - local) + 0 * SHORTEST)[0])
        if not abs(claimed - seen) <= NEAR * seen:
            raise InputError(f"{named}: its transverse_stiffness is {claimed:.6g}, that of its "
                             f"shortest waves {seen:.6g} of that along them: mend it, or take "
                             "Body.transverse_stiffness")


def _check_far_field(body, c, q, named):
    """InputError unless an isolated body is the layer that it names, but for its springs.

    Parameters
    ----------
    body : Body
    c : Surface, its compliance
    q : array, wave numbers, 1/beta
    named : str
    """
    layer, (normal, tangential) = body.far_field(), body.local_compliance
    if not isinstance(layer, Layer):
        raise InputError(f"{named}: its far_field() is {layer!r}: it has to be a Layer, or None")
    known = layer_compliance(q, layer.poisson, layer.height)
    for words, values, others, size in (
            ("normal", c.normal, known.normal + normal, c.normal),
            ("longitudinal", c.longitudinal, known.longitudinal + tangential, c.longitudinal),
            ("transverse", c.transverse, known.transverse + tangential, c.transverse),
            ("coupling", c.coupling, known.coupling, np.sqrt(c.normal * c.longitudinal))):
        _refuse(f"{named}, which says by its far_field() that it is {layer!r} but for its "
                f"local_compliance: its {words} compliance", q, values,
                ~(np.abs(values - others) <= ALIKE * size),
                "that of this layer, or far_field = Body.far_field and a finite -scene_period")


def _waves(scene):
    """Wave numbers at which a body is looked at, 1/beta, in their order; where the grid has yet to
    be chosen, without its own."""
    longest = max((period for period in scene.periods if np.isfinite(period)), default=100.0)
    q = 2 * np.pi / longest * WAVES
    if scene.isolated or scene.points == "auto":
        return q
    axes = [2 * np.pi / period * np.arange(points // 2 + 1) for period, points in zip(scene.periods,
                                                                                      scene.shape)]
    if len(axes) > 1 and np.prod([len(axis) for axis in axes]) <= MANY:
        axes = [np.hypot(*np.meshgrid(*axes)).reshape(-1)]
    q = np.unique(np.concatenate([q, *axes]))
    return q[q > 0]


def _refuse(words, q, values, wrong, meant):
    """InputError that tells of the first wave number at which a value is wrong."""
    if np.any(wrong):
        place = np.argmax(np.broadcast_to(wrong, q.shape))
        raise InputError(f"{words} is {np.broadcast_to(values, q.shape)[place]:.9g} at the wave "
                         f"number {q[place]:.6g} 1/beta: it has to be {meant}")
