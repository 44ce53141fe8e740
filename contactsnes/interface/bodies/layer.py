"""The elastic layer, and the half-space."""

import math

import numpy as np

from ...options.fields import as_text, option
from .. import elasticity
from .body import Body

# Below this relative size a block of the compliance is rounding.
_VANISHING = 1e-15
# Height, beta, from which on an incompressible layer is a half-space to a sphere.
_TALL = 1000.0


class Layer(Body):
    """An elastic layer that is held at its top, or for height ``inf`` a half-space."""

    name, meaning = "layer", "of -scene_height and -scene_poisson"
    poisson: float = option(0.5, "Poisson ratio", minimum=0, maximum=0.5)
    height: float = option(2000.0, "height of the layer", "beta", above=0, infinite=True)

    def surface(self, wavenumber):
        """`elasticity.layer_compliance`."""
        return elasticity.layer_compliance(wavenumber, self.poisson, self.height)

    def surface_stiffness(self, wavenumber):
        """`elasticity.layer_stiffness`, exact where the layer is nearly incompressible, too."""
        return elasticity.layer_stiffness(wavenumber, self.poisson, self.height)

    @property
    def rigid_compliance(self):
        """1/k_0; 0 where `elasticity.rigid_stiffness` is infinite."""
        normal, tangential = elasticity.rigid_stiffness(self.poisson, self.height)
        return 1 / normal, 1 / tangential

    def couples(self, smallest_wavenumber):
        """Whether normal and tangential directions couple above rounding at q >=
        `smallest_wavenumber`.

        The coupling relative to sqrt(C_nn C_LL) tends to Dundurs' constant for
        large qH; the rest, k^2 exp(-2k), is largest at the smallest q.
        """
        c = elasticity.layer_compliance(smallest_wavenumber, self.poisson, self.height)
        relative = abs(c.coupling) / np.sqrt(c.normal * c.longitudinal)
        dundurs = (1 - 2 * self.poisson) / (2 * (1 - self.poisson))
        return bool(max(relative, dundurs) > _VANISHING)

    def anisotropy(self, smallest_wavenumber):
        """The Poisson ratio for short waves, the rest is largest at the smallest q."""
        c = elasticity.layer_compliance(smallest_wavenumber, self.poisson, self.height)
        return max(self.poisson, abs(c.longitudinal / c.transverse - 1))

    @property
    def transverse_stiffness(self):
        """(1 - nu)/2 over 1/2."""
        return 1.0 - self.poisson

    def coupled(self, scene):
        """At Poisson ratio 1/2 the coupling is k^2/sinh(k)^2 of the diagonal, k = 2 pi H/L, so only
        thin layers have it; an isolated contact strains its layer by force/H, in a plane by force x
        length/H^2."""
        if scene.isolated:
            return self.poisson < 0.5 or self.height < {1: math.inf, 2: _TALL}[scene.dimension]
        k = 2 * math.pi * self.height / max(scene.periods)
        return self.poisson < 0.5 or (k < 30 and (k / math.sinh(k)) ** 2 > 1e-16)

    def far_field(self):
        """Itself."""
        return self

    def about(self, scene, size):
        """Poisson ratio and height."""
        height = (f"height {size(self.height, 'beta', 8)}" if math.isfinite(self.height)
                  else "infinite height")
        return [f"Poisson ratio {as_text(self.poisson)}", height]
