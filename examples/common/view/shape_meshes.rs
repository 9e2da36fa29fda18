//! Meshes and materials of obstacles.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape_script::recording::Form;

/// Side of the piece of a plane that is shown, in metres.
pub const PLANE: f32 = 600.0;

/// A mesh, and where it is in the obstacle's coordinates.
pub type Placed = (Mesh, Transform);

/// The mesh of an obstacle of a recording. None for the inside of a box.
pub fn mesh_of(form: Form) -> Option<Placed> {
    let (half, middle) = match form {
        Form::HalfSpace { normal } => return Some(plane(Vec3::from_array(normal))),
        Form::Sphere { radius } => return Some((Sphere::new(radius).mesh().uv(48, 24), Transform::IDENTITY)),
        Form::Capsule { half_length, radius } => {
            let capsule = Capsule3d::new(radius, 2.0 * half_length).mesh().build();
            return Some((capsule, Transform::IDENTITY));
        }
        Form::TaperedCapsule { half_length, bottom_radius, top_radius } => {
            return Some((tapered_capsule(half_length, bottom_radius, top_radius), Transform::IDENTITY));
        }
        Form::Cuboid { half_extents } => (Vec3::from_array(half_extents), Vec3::ZERO),
        Form::Container { .. } => return None,
        Form::Other { low, high } => {
            let [low, high] = [low, high].map(Vec3::from_array);
            ((high - low) * 0.5, (low + high) * 0.5)
        }
    };
    let is_box = half.is_finite() && middle.is_finite();
    is_box.then(|| (Cuboid::from_size(half * 2.0).mesh().build(), Transform::from_translation(middle)))
}

/// A tapered capsule: a sphere that is pulled apart where its normal is square to the cone's side.
pub fn tapered_capsule(half_length: f32, bottom_radius: f32, top_radius: f32) -> Mesh {
    let mut mesh = Sphere::new(1.0).mesh().uv(48, 48);
    let slope = (bottom_radius - top_radius) / (2.0 * half_length);
    if let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION) {
        for place in places {
            // Bevy's sphere has its poles on Z.
            let normal = Vec3::new(place[0], place[2], -place[1]);
            let (height, radius) =
                if normal.y > slope { (half_length, top_radius) } else { (-half_length, bottom_radius) };
            *place = (normal * radius + Vec3::Y * height).to_array();
        }
    }
    mesh.with_computed_smooth_normals()
}

pub fn plane(normal: Vec3) -> Placed {
    let turn = Quat::from_rotation_arc(Vec3::Y, normal.normalize_or(Vec3::Y));
    let mesh = Plane3d::default().mesh().size(PLANE, PLANE).build();
    // Waves of water need tangents; a plane has what they are made from.
    let mesh = mesh.clone().with_generated_tangents().unwrap_or(mesh);
    (mesh, Transform::from_rotation(turn))
}

/// Triangles with edges that are seen.
pub fn flat(corners: &[Vec3], triangles: &[[u32; 3]]) -> Mesh {
    let corner = |index: &u32| corners.get(*index as usize).copied().unwrap_or_default();
    let positions: Vec<Vec3> = triangles.iter().flatten().map(corner).collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_computed_flat_normals()
}

/// The material of an obstacle: transparent if only its bounding box is known.
pub fn material_of(form: Form, colour: Color) -> StandardMaterial {
    let is_known = !matches!(form, Form::Other { .. });
    StandardMaterial {
        base_color: if is_known { colour } else { colour.with_alpha(0.25) },
        alpha_mode: if is_known { AlphaMode::Opaque } else { AlphaMode::Blend },
        ..solid(colour)
    }
}

/// The material of obstacles of this colour. Thin sheets are seen from both sides.
pub fn solid(colour: Color) -> StandardMaterial {
    StandardMaterial {
        base_color: colour,
        perceptual_roughness: 0.9,
        reflectance: 0.15,
        double_sided: true,
        cull_mode: None,
        ..default()
    }
}
