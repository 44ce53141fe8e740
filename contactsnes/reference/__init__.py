"""Analytic solutions to compare a numerical contact with.

Units and signs
---------------
Line contacts are dimensionless: contact modulus E*, radius R and normal work of adhesion phi_n are
1. Lengths along the surface are in beta = (R^2 phi_n/E*)^(1/3), normal displacements and approaches
in beta^2/R, loads (per length) in E* beta^2/R, stresses in E* beta/R; tangential quantities carry a
further sqrt(phi_t/phi_n), so that phi_t is 1 too. Spheres take `contact_modulus`, `radius` and
`work_of_adhesion` in any consistent units, 1 by default. Pressures, loads and approaches are
positive in compression. Normal and tangential directions are elastically decoupled, as for an
incompressible body on a rigid counterface.

Subjects
--------
line : a normal load without adhesion (`hertz_line_...`) or with one of short range
    (`jkr_line_...`), the bonded strip (`ligament_...`); isolated or periodic
sinusoid : the same on a wave (`sinusoid_...`)
cohesive : a normal load with adhesion of finite range (`maugis_line...`), and the rigid limit
    (`rigid_cylinder_...`)
slip : shear of line contacts that slip: zones of constant traction (`slip_zone_...`) with a front
    (`front_...`), the whole contact (`uniform_slip_...`, `sliding_...`)
coulomb : shear of line contacts with Coulomb friction (`cattaneo_line_...`)
drive : the layer that shears a contact (`drive_...`, `driven_...`), and whether sliding starts with
    a jump
mixed_mode : shear of bonded adhesive contacts (`mixed_mode_...` of lines and spheres,
    `savkoor_briggs_line_load`)
sphere : spheres under a normal load (`hertz_...`, `jkr_...`, `dmt_...`)
sphere_cohesive : the same with adhesion of finite range (`maugis_sphere...`)
sphere_shear : spheres under shear (`bonded_circle_...`, `cattaneo_sphere`,
    `savkoor_briggs_sphere_...`)
laws : peaks and works of the traction-separation laws

Common arguments
----------------
x, r : float or array, distance from the centre of the contact
half_width, contact_radius : float or array >= 0, a; below half the period
period : float, length L of the periodic cell; `inf` (default) is the isolated contact
work_of_adhesion : float, w; lines: in units of phi_n, 0 gives Hertz's solutions; spheres: > 0
load, tangential_force : float; for line contacts per cell
Results have the shape of the arguments, arrays being broadcast; a period is one number. Functions
that find a state from a load or an approach find the one that is stable when that quantity is
prescribed, floats for floats, at arrays element by element. Each says under which conditions it
applies; all raise ValueError for arguments out of range and where no equilibrium exists.

Periodic line contacts are sums of rigid flat punches of half width b: `ligament_traction` per unit
of force lifts the contact by (2/pi) ln(1/sin(pi b/L)) above the mean surface. Abel's equation gives
the density of punches that yields a profile, (L/2) tan(pi b/L) for the parabola x^2/2 (so the
solution is exact and closed; compare Block & Keer 2008) and (2 pi^2 A/L) sin(pi b/L) cos(pi b/L)
for the wave A(1 - cos 2 pi x/L), which is Westergaard's solution.

References
----------
Baney & Hui 1997, J. Adhes. Sci. Technol. 11; Barquins 1988, J. Adhes. 26; Block & Keer 2008, J.
Mech. Mater. Struct. 3; Bradley 1932, Phil. Mag. 13; Cattaneo 1938, Rend. Lincei 27; Ciavarella
1998, Int. J. Solids Struct. 35; Derjaguin, Muller & Toporov 1975, J. Colloid Interface Sci. 53;
Hutchinson & Suo 1992, Adv. Appl. Mech. 29; Johnson 1985, Contact Mechanics; Johnson 1995, Int. J.
Solids Struct. 32; Johnson & Greenwood 1997, J. Colloid Interface Sci. 192, 2005, J. Phys. D 38, and
2008, J. Phys. D 41; Johnson, Kendall & Roberts 1971, Proc. R. Soc. A 324; Maugis 1992, J. Colloid
Interface Sci. 150; McGarry et al. 2014, J. Mech. Phys. Solids 63; Mindlin 1949, J. Appl. Mech. 16;
Papangelo & Ciavarella 2019, J. Mech. Phys. Solids 124; Papangelo et al. 2019, Phys. Rev. E 99;
Savkoor & Briggs 1977, Proc. R. Soc. A 356; Tada, Paris & Irwin 2000, The Stress Analysis of Cracks
Handbook; Waters & Guduru 2010, Proc. R. Soc. A 466; Westergaard 1939, J. Appl. Mech. 6.
"""

from .cohesive import (
    maugis_line,
    maugis_line_approach,
    maugis_line_pressure,
    maugis_line_pull_off,
    rigid_cylinder_load,
    rigid_cylinder_pull_off,
)
from .coulomb import (
    cattaneo_line_displacement,
    cattaneo_line_stick_half_width,
    cattaneo_line_traction,
)
from .drive import drive_critical_height, drive_stiffness, driven_displacement, driven_fold
from .ellipse import ellipse_intensities, mixed_mode_ellipse
from .laws import (
    fading_slip,
    fading_work,
    front_work,
    mcgarry_proportional_work,
    mcgarry_sequential_work,
    modified_tangential_work,
    normal_work,
    peak_normal_traction,
    peak_tangential_traction,
)
from .line import (
    hertz_line_approach,
    hertz_line_half_width,
    hertz_line_load,
    hertz_line_pressure,
    jkr_line_approach,
    jkr_line_fold,
    jkr_line_half_width,
    jkr_line_half_width_at_approach,
    jkr_line_load,
    jkr_line_pressure,
    jkr_line_pull_off,
    ligament_force,
    ligament_stiffness,
    ligament_traction,
)
from .mixed_mode import (
    mixed_mode_line,
    mixed_mode_line_half_width,
    mixed_mode_line_strength,
    mixed_mode_sphere,
    mixed_mode_sphere_radius,
    mixed_mode_sphere_strength,
    mixed_mode_toughness,
    savkoor_briggs_line_load,
)
from .sinusoid import sinusoid_approach, sinusoid_half_width, sinusoid_load, sinusoid_pressure
from .slip import (
    front_force,
    front_onset,
    sliding_force,
    sliding_half_width,
    slip_zone_edge_slip,
    slip_zone_force,
    slip_zone_traction,
    uniform_slip_force,
    uniform_slip_onset,
    uniform_slip_softening,
    uniform_slip_state,
)
from .sphere import (
    dmt_sphere,
    dmt_sphere_radius,
    hertz_sphere,
    hertz_sphere_pressure,
    hertz_sphere_radius,
    jkr_force,
    jkr_sphere,
    jkr_sphere_fold,
    jkr_sphere_pressure,
    jkr_sphere_pull_off,
    jkr_sphere_radius,
    jkr_sphere_radius_at_approach,
)
from .sphere_cohesive import (
    maugis_sphere,
    maugis_sphere_pressure,
    maugis_sphere_pull_off,
    sphere_maugis_parameter,
)
from .sphere_shear import (
    bonded_circle_stiffness,
    cattaneo_sphere,
    cattaneo_sphere_traction,
    savkoor_briggs_ratio,
    savkoor_briggs_sphere_load,
    savkoor_briggs_sphere_radius,
    savkoor_briggs_sphere_strength,
)

__all__ = sorted(name for name, value in globals().items() if callable(value))
