//! A world reports contacts by the names of the two sides.

use drape_solver::glam::Vec3;
use drape_solver::{MemberId, Obstacle, Placement, Shape, WorldId};

use crate::common::*;

#[test]
fn touches_contacts_and_reactions_have_names() {
    let mut world = on_ground();
    // An earlier ball makes indices in islands differ from those in the world.
    world.add_ball(ball(Vec3::new(9.0, 50.0, 0.0), Vec3::ZERO));
    let table = Shape::Cuboid { half_extents: Vec3::new(1.0, 0.05, 1.0) };
    let table = Obstacle::new(table, Placement::at(Vec3::Y * 0.95), 0.5).expect("valid");
    let table = world.add_obstacle(table.reporting_reaction());
    let mut reporting = sheet(Vec3::Y * 1.02);
    reporting.reports_contacts = true;
    let cloth = world.add_body(reporting);
    let dropped = world.add_ball(ball(Vec3::Y * 1.3, Vec3::ZERO));
    let (mut touches, mut contacts, mut impulse) = (Vec::new(), Vec::new(), 0.0);
    for _ in 0..60 {
        world.step().expect("a good step");
        let events = world.events();
        touches.extend(events.touches.iter().map(|touch| (touch.ball, touch.other)));
        contacts.extend(events.contacts.iter().map(|contact| (contact.party, contact.other)));
        for reaction in &events.reactions {
            assert_eq!(reaction.obstacle, table);
            impulse += reaction.reaction.impulse.y;
        }
    }
    assert!(touches.contains(&(dropped, WorldId::Body(cloth))));
    assert!(touches.iter().all(|&(ball, _)| ball == dropped));
    assert!(contacts.contains(&(MemberId::Body(cloth), WorldId::Obstacle(table))));
    assert!(contacts.contains(&(MemberId::Ball(dropped), WorldId::Body(cloth))));
    // The weight of both, over a second.
    assert!((impulse / -(2.0 + 0.2) / 9.81 - 1.0).abs() < 0.2, "{impulse} N s");
}
