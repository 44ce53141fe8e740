"""A layer with a thin coating."""

from ...options.fields import InputError, as_text, option
from .. import laws
from .body import Body
from .layer import Layer


class Coated(Layer):
    """A layer whose surface carries a coating so thin that each of its places deforms for itself
    (Winkler): C(q) + c, with a constant c of the normal direction and one of the tangential ones.

    Of a coating of thickness d, modulus E_c and Poisson ratio nu_c, thin beside the contact and
    bonded: c_n = (1 + nu_c)(1 - 2 nu_c) d/((1 - nu_c) E_c), c_t = 2 (1 + nu_c) d/E_c.
    """

    name, meaning = "coated", "the layer with a thin coating, -scene_coating_*"
    coating_normal: float = option(0.0, "normal compliance of a thin coating: thickness over its "
                                   "constrained modulus", "beta/E*", minimum=0)
    coating_tangential: float = option(0.0, "tangential compliance of a thin coating: thickness "
                                       "over its shear modulus", "beta/E*", minimum=0)

    @property
    def local_compliance(self):
        """That of the coating."""
        return self.coating_normal, self.coating_tangential

    def surface(self, wavenumber):
        """That of the layer, and that of the coating in series."""
        layer = super().surface(wavenumber)
        return layer._replace(normal=layer.normal + self.coating_normal,
                              longitudinal=layer.longitudinal + self.coating_tangential,
                              transverse=layer.transverse + self.coating_tangential)

    def surface_stiffness(self, wavenumber):
        """The inverse of the compliance; of the layer alone, its own."""
        if any(self.local_compliance):
            return Body.surface_stiffness(self, wavenumber)
        return super().surface_stiffness(wavenumber)

    @property
    def rigid_compliance(self):
        """That of the layer, and that of the coating in series."""
        return tuple(layer + coating
                     for layer, coating in zip(super().rigid_compliance, self.local_compliance))

    def far_field(self):
        """The layer."""
        return Layer(self.poisson, self.height).with_work_ratio(self.work_ratio)

    def check(self, scene, sheared=False):
        """InputError where the law softens faster than the coating is stiff: places of the coating
        snap on their own then, on every grid."""
        law = laws.of(scene)
        normal = law.softening * scene.normal_maugis ** 2
        cases = [("coating_normal", normal, self.coating_normal)]
        if sheared:
            tangential = law.slip_softening * scene.tangential_maugis ** 2
            both = law.coupled_softening(scene.normal_maugis, scene.tangential_maugis)
            softer = max(("coating_normal", "coating_tangential"), key=lambda name: getattr(self,
                                                                                            name))
            cases += [("coating_tangential", tangential, self.coating_tangential),
                      (softer, both, getattr(self, softer))]
        for name, softening, compliance in cases:
            if not softening * compliance < 1.0:
                raise InputError(f"{scene.option_name(name)} is "
                                 f"'{as_text(scene.as_typed(name))}': the law softens by "
                                 f"{softening:.4g} E*/beta, so that a coating this soft snaps on "
                                 "and off at each place for itself; allowed is less than "
                                 f"{scene.told(1.0 / softening, 'beta/E*'):.4g}, or take a softer "
                                 "law")

    def about(self, scene, size):
        """The layer and the coating."""
        normal, tangential = (size(value, "beta/E*", 8) for value in self.local_compliance)
        return [*super().about(scene, size),
                f"coating of normal compliance {normal}, tangential {tangential}"]
