//! Complete scenes as users write them, which runs vary.

/// A capsule in shear flow. Lengths are in radii, moduli in units of G, and the rate is Ca.
pub(super) const CAPSULE: &str = r#"
units = "none"
[[surface]]
name = "capsule"
shape = "sphere:1"
family = "regular"
vertices = 162
match_volume = true
viscosity_ratio = 1
elasticity = { law = "neo-hookean", shear_modulus = 1 }
bending = { method = "gompper-kroll", modulus = 0.1 }
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 0.15 }
strain = 1
[output]
strain_interval = 0.25
surfaces = false
pictures = false
"#;

/// Two capsules one above the other, in a flow that presses them together.
pub(super) const PRESSED: &str = r#"
units = "none"
[[surface]]
name = "lower"
shape = "sphere:1"
family = "regular"
vertices = 162
match_volume = true
position = [0, -1.15, 0]
elasticity = { law = "skalak", shear_modulus = 1, area_ratio = 1 }
bending = { method = "gompper-kroll", modulus = 0.05 }
[[surface]]
name = "upper"
shape = "sphere:1"
family = "regular"
vertices = 162
match_volume = true
position = [0, 1.15, 0]
elasticity = { law = "skalak", shear_modulus = 1, area_ratio = 1 }
bending = { method = "gompper-kroll", modulus = 0.05 }
[[interaction]]
kind = "repulsion"
strength = 5
cutoff = 0.3
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "plane-extension", rate = 0.15 }
strain = 2
[output]
strain_interval = 0.5
surfaces = false
pictures = false
"#;

/// A vesicle of reduced volume 0.6 in shear flow: fluid, and nearly inextensible at every point.
pub(super) const DEFLATED: &str = r#"
units = "none"
[[surface]]
name = "vesicle"
shape = "ellipsoid:2.85,0.525,0.525"
family = "smooth"
vertices = 162
bending = { method = "gompper-kroll", modulus = 1 }
local_area = { modulus = 200 }
[driver]
kind = "boundary-integral"
viscosity = 1
flow = { kind = "shear", rate = 2 }
strain = 2
[output]
strain_interval = 0.5
surfaces = false
pictures = false
"#;

/// A vesicle of this reduced volume that relaxes with area and volume held.
pub(super) const RELAXED: &str = r#"
units = "none"
[[surface]]
name = "vesicle"
shape = "ellipsoid:1.4,1.4,0.35"
family = "relaxed"
vertices = 642
bending = { method = "gompper-kroll", modulus = 1 }
area = { constraint = "exact" }
volume = { constraint = "exact", reduced = 0.6 }
[driver]
kind = "relax"
energy_error = 0.1
[output]
every = 20
surfaces = false
pictures = false
"#;

/// A capsule on a coarse lattice.
pub(super) const ON_LATTICE: &str = r#"
units = "none"
[[surface]]
name = "capsule"
shape = "sphere:1"
family = "regular"
vertices = 162
match_volume = true
elasticity = { law = "neo-hookean", shear_modulus = 1 }
bending = { method = "gompper-kroll", modulus = 0.01 }
[driver]
kind = "lattice-boltzmann"
viscosity = 1
flow = { kind = "shear", rate = 0.15 }
resolution = 3
box = [7, 7, 7]
strain = 1
[output]
strain_interval = 0.25
surfaces = false
pictures = false
"#;

/// A capsule in a channel with a ball in it.
pub(super) const CHANNEL: &str = r#"
units = "none"
[[surface]]
name = "capsule"
shape = "sphere:1"
vertices = 162
elasticity = { law = "skalak", shear_modulus = 1, area_ratio = 1 }
bending = { method = "gompper-kroll", modulus = 0.01 }
[[obstacle]]
name = "ball"
shape = "sphere:1"
vertices = 162
position = [1.5, 0, 0]
[driver]
kind = "lattice-boltzmann"
viscosity = 1
flow = { kind = "channel", centre_velocity = 0.3 }
duration = 1
resolution = 3
box = [8, 4, 4]
[output]
interval = 1
surfaces = false
pictures = false
"#;
