//! The sample of the README: a curtain in a breeze.
//!
//! `cargo run --release --example readme --features window`

use bevy::prelude::*;
use bevy_drape::prelude::*;

fn main() {
    App::new().add_plugins((DefaultPlugins, DrapePlugins::default())).add_systems(Startup, setup).run();
}

fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    // Cloth is seen from both sides. It hangs by its top edge; the plugin makes its mesh.
    let red = Color::srgb(0.7, 0.05, 0.05);
    let red = StandardMaterial { base_color: red, double_sided: true, cull_mode: None, ..default() };
    commands.spawn((Cloth::new(2.0, 1.5), MeshMaterial3d(materials.add(red))));
    commands.insert_resource(Wind::new(Vec3::new(1.0, 0.0, -1.0)));

    let look_from = |place: Vec3| Transform::from_translation(place).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((Camera3d::default(), look_from(Vec3::new(-1.0, 0.2, 2.5))));
    commands.spawn((DirectionalLight::default(), look_from(Vec3::new(-4.0, 2.0, 3.0))));
}
