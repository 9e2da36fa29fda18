//! A shirt under a jacket under a cape: layers that touch each other and the body keep their order.

use core::f32::consts::PI;

use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::drape_solver::parry3d::query::{Ray, RayCast};
use bevy_drape::drape_solver::parry3d::shape::TriMesh;
use bevy_drape::prelude::*;
use drape_solver::state::measure::crossings;

use crate::body::{depth_in, parts};
use crate::*;
use drape_examples::character::{self, CHEST, Character, SPRINT};

/// The clothes as a surface, in the coordinates of a joint.
fn surface(app: &App, garment: Entity, joint: Entity) -> TriMesh {
    let to_joint = global(app, joint).affine().inverse();
    let places = particles(app, garment).positions().map(|place| to_joint.transform_point3(place));
    let sticks = app.world().get::<Sticks>(garment).expect("built");
    TriMesh::new(places.collect(), sticks.faces().to_vec()).expect("faces")
}

/// The numbers of rays from the trunk backwards on which shirt and jacket, and jacket and cape, lie over each other; all in order.
fn ordered(app: &App, character: &Character, outfit: [Entity; 3]) -> [usize; 2] {
    let surfaces = outfit.map(|garment| surface(app, garment, character.joints[CHEST]));
    let mut found = [0; 2];
    for (height, part) in (-4..=1).flat_map(|height| (1..=9).map(move |part| (height, part))) {
        let angle = PI * part as f32 / 10.0;
        let from = Vec3::new(0.0, 0.05 * height as f32, 0.0);
        let ray = Ray::new(from, Vec3::new(libm::cosf(angle), 0.0, libm::sinf(angle)));
        let [shirt, jacket, cape] = [0, 1, 2].map(|k| surfaces[k].cast_local_ray(&ray, 2.0, false));
        for (under, over, count) in [(shirt, jacket, 0), (jacket, cape, 1)] {
            if let (Some(under), Some(over)) = (under, over) {
                assert!(under < over, "{under} m over {over} m at {height}, {angle}");
                found[count] += 1;
            }
        }
    }
    found
}

#[test]
fn layers_keep_their_order_at_a_sprint_a_turn_and_a_fall() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let mut character = character::spawn_figure(app.world_mut());
    let outfit = character::spawn_outfit(app.world_mut(), &character);
    app.finish();
    app.cleanup();
    one_step_a_frame(&mut app);
    let skin = parts();
    let (mut deepest, mut found) = (0.0_f32, [0; 2]);
    let mut deep = Vec::new();
    for step in 0..(60.0 * SPRINT) as usize {
        let (root, joints) = character.sprint(step as f32 / 60.0);
        character.show(app.world_mut(), root, &joints);
        app.update();
        let bodies = outfit.map(|garment| {
            let sticks = app.world().get::<Sticks>(garment).expect("built");
            (&**particles(&app, garment), &*sticks.0)
        });
        assert_eq!(crossings(bodies.into_iter()), 0, "step {step}");
        let before = core::mem::take(&mut deep);
        for (joint, part) in &skin {
            let to_part = global(&app, character.joints[*joint]).affine().inverse();
            for garment in outfit {
                let body = particles(&app, garment);
                for i in (0..body.len()).filter(|&i| !body.is_pinned(i)) {
                    let depth = depth_in(part, to_part.transform_point3(body.position(i)));
                    deepest = deepest.max(depth);
                    if depth > 3e-3 {
                        deep.push((garment, i));
                    }
                }
            }
        }
        // In the about-turn layers press one particle after another of an edge deeper into an arm, each for a step.
        assert!(deepest < 0.01, "step {step}: {deepest} m deep in the skin");
        assert!(deep.len() < 4, "step {step}: {deep:?} are deep in the skin");
        assert!(
            !deep.iter().any(|particle| before.contains(particle)),
            "step {step}: {deep:?} stay in the skin"
        );
        if step % 30 == 0 {
            let now = ordered(&app, &character, outfit);
            assert!(now[0] > 40 && now[1] > 5, "step {step}: {now:?} rays");
            found = [found[0] + now[0], found[1] + now[1]];
        }
    }
    println!("outfit: {deepest} m deep in the skin; {found:?} rays in order");
    assert!(app.world().resource::<Refusals>().is_empty());
}
