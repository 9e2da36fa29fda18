//! A free rigid body spins on about its axis, and slows only by the damping of the substep.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::{BodySettings, Island};

use crate::common::*;

/// A regular tetrahedron of four particles of 1 kg and six sticks that spins about `axis` with `spin` rad/s.
fn tetrahedron(axis: Vec3, spin: f32, settings: BodySettings) -> Island {
    let corners =
        [Vec3::ONE, Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)];
    let corners = corners.map(|corner| corner * 0.3);
    let sticks = [[0, 1], [2, 3], [0, 2], [1, 3], [0, 3], [1, 2]];
    let mut body = joined(&corners, &[1.0; 4], &sticks, settings);
    for (i, corner) in corners.into_iter().enumerate() {
        body.particles.set_velocity(i, (axis * spin).cross(corner));
    }
    Island::of_body(body)
}

/// Projection takes the part `w^2 h` of the spin each second (`dw/dt = -w^3 h`); for small losses, `exp(-w^2 h t)` is left.
/// A body with equal moments of inertia keeps its axis, whichever it is. (Short substeps show the rounding of positions, as
/// a slow spin rotates little in each.)
#[test]
fn the_spin_of_a_tetrahedron_decays_with_its_square_and_the_substep() {
    for axis in [Vec3::Y, Vec3::new(1.0, 2.0, -0.5).normalize()] {
        for (spin, substeps, tolerance, lean_tolerance) in
            [(2.0, 8, 0.035, 2e-3), (5.0, 8, 3e-3, 4e-4), (5.0, 32, 0.1, 0.017), (10.0, 32, 7e-3, 3e-3)]
        {
            let settings = BodySettings { substeps, iterations: 8, ..bare() };
            let mut island = tetrahedron(axis, spin, settings);
            let start = angular_momentum(&island);
            let seconds = 2.0;
            run(&mut island, &weightless(FRAME), seconds);
            let end = angular_momentum(&island);
            let h = f64::from(FRAME) / f64::from(substeps);
            let w = f64::from(spin);
            let case = format!("{spin} rad/s, {substeps} substeps, about {axis:.1}");
            let decay = 0.5 * ((start.length() / end.length()).powi(2) - 1.0) / f64::from(seconds);
            law(&format!("tetrahedron's decay of spin, {case}"), decay, w * w * h, tolerance);
            let lean = end.normalize().angle_between(DVec3::from(axis));
            law_of_error(&format!("tetrahedron's lean of the axis in rad, {case}"), lean, lean_tolerance);
        }
    }
}
