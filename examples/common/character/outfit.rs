//! A shirt, a jacket and a cape, one over the other: skinned meshes with pins and limits painted on them.

use core::f32::consts::{FRAC_PI_2, PI, TAU};
use core::ops::Range;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::render::PaintChannel;

use crate::character::gltf_file::NECK_AND_SHOULDERS;
use crate::character::skeleton::{CHEST, HIPS, SPINE, THIGHS, inverse_bind_poses, skinned};
use crate::character::walk_cycle::Character;

/// A ring round the body, in metres: how far it reaches at its sides and how high it is there, then the same before and behind.
type Ring = [f32; 4];

/// A piece of clothing, wound round the axis of the body from the neck down.
struct Garment {
    name: &'static str,
    rings: &'static [Ring],
    /// Distance from the rings outwards, in metres.
    offset: f32,
    /// Angle that is left open, in the middle of the front.
    opening: f32,
    /// Edges round the body, and from neck to hem.
    columns: usize,
    rows: usize,
    /// Rows of the holes for the arms, and half their angle round the body.
    armholes: (Range<usize>, f32),
    /// Greatest distance of the hem from its animated place, in metres.
    freedom: f32,
    fabric: Fabric,
}

/// From the neck over the shoulders and under the arms to the thighs.
const TRUNK: [Ring; 10] = [
    [0.080, 1.560, 0.080, 1.550],
    [0.115, 1.545, 0.105, 1.525],
    [0.150, 1.522, 0.125, 1.495],
    [0.160, 1.490, 0.136, 1.455],
    [0.140, 1.400, 0.139, 1.400],
    [0.138, 1.320, 0.138, 1.320],
    [0.134, 1.150, 0.134, 1.150],
    [0.155, 1.020, 0.145, 1.020],
    [0.205, 0.900, 0.160, 0.900],
    [0.245, 0.640, 0.225, 0.640],
];

/// Over the shoulders, and behind the arms to the calves.
const CLOAK: [Ring; 8] = [
    [0.125, 1.590, 0.125, 1.580],
    [0.160, 1.575, 0.145, 1.550],
    [0.200, 1.555, 0.165, 1.505],
    [0.240, 1.520, 0.175, 1.455],
    [0.255, 1.450, 0.185, 1.380],
    [0.275, 1.200, 0.200, 1.150],
    [0.330, 0.800, 0.235, 0.780],
    [0.370, 0.450, 0.270, 0.450],
];

/// Height of the waist in metres.
const WAIST: f32 = 1.15;

/// From the skin outwards.
const OUTFIT: [Garment; 3] = [
    Garment {
        name: "Shirt",
        rings: &TRUNK,
        offset: 0.0,
        opening: 0.0,
        columns: 32,
        rows: 28,
        // Wider than those of the jacket, which covers their edges.
        armholes: (2..7, 0.8),
        freedom: 0.2,
        fabric: Fabric { areal_density: 0.15, thickness: 0.003, drag: 1.0, friction: 0.2, ..Fabric::COTTON },
    },
    Garment {
        name: "Jacket",
        rings: &TRUNK,
        offset: 0.011,
        opening: 0.5,
        columns: 30,
        rows: 25,
        armholes: (2..6, 0.62),
        freedom: 0.3,
        fabric: Fabric { areal_density: 0.4, thickness: 0.004, drag: 1.0, friction: 0.2, ..Fabric::DENIM },
    },
    Garment {
        name: "Cape",
        rings: &CLOAK,
        offset: 0.0,
        opening: TAU - 2.2,
        columns: 18,
        rows: 32,
        armholes: (0..0, 0.0),
        freedom: 0.8,
        fabric: Fabric { areal_density: 0.25, thickness: 0.004, drag: 1.0, friction: 0.2, ..Fabric::COTTON },
    },
];

/// Dresses a character: the entities of its clothes, from the skin outwards. They lie on its neck and shoulders too.
pub fn spawn_outfit(world: &mut World, character: &Character) -> [Entity; OUTFIT.len()] {
    for ((joint, radius, length, middle), turn) in NECK_AND_SHOULDERS.into_iter().zip([0.0, FRAC_PI_2]) {
        let place = Transform::from_translation(middle).with_rotation(Quat::from_rotation_z(turn));
        let obstacle = Obstacle::capsule(radius, length).with_friction(0.3);
        world.spawn((obstacle, place, Visibility::Hidden, ChildOf(character.joints[joint])));
    }
    OUTFIT.map(|garment| {
        let skinned = skinned(world, garment.mesh(), &character.joints, inverse_bind_poses());
        let paint = ClothPaint {
            max_distance: Some(PaintChannel::Green),
            full_distance: garment.freedom,
            ..default()
        };
        let touches_cloth = SolverSettings { self_contact: SelfContact::On, ..default() };
        let cloth = (ClothMesh { paint, ..default() }, garment.fabric, touches_cloth);
        let motion = WorldMotion::of(character.root).with_scale(0.8, 0.5);
        world.spawn((Name::new(garment.name), skinned, cloth, motion, ChildOf(character.root))).id()
    })
}

impl Garment {
    /// The mesh in the pose in which arms hang down: red paints pins, green paints limits of motion.
    fn mesh(&self) -> Mesh {
        // A ring that closes ends where it begins.
        let round = if self.opening == 0.0 { self.columns } else { self.columns + 1 };
        let squares = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        let squares = squares.filter(|&(column, row)| !self.is_armhole(column, row));
        let corners: Vec<[(usize, usize); 4]> = squares
            .map(|(column, row)| {
                let next = (column + 1) % round;
                [(row, column), (row, next), (row + 1, column), (row + 1, next)]
            })
            .collect();
        let mut vertices: Vec<(usize, usize)> = corners.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let index = |corner| vertices.partition_point(|vertex| *vertex < corner) as u32;
        let triangles = |square: &[(usize, usize); 4]| {
            let [a, b, c, d] = square.map(index);
            [a, b, d, a, d, c]
        };
        let indices = corners.iter().flat_map(triangles).collect();
        let places: Vec<Vec3> = vertices.iter().map(|&(row, column)| self.place(column, row)).collect();
        let uvs = vertices.iter().map(|&(row, column)| {
            [column as f32 / self.columns as f32, row as f32 / self.rows as f32].map(|part| 3.0 * part)
        });
        let colours = vertices.iter().map(|&(row, _)| {
            let down = row as f32 / self.rows as f32;
            [f32::from(row == 0), down, 0.0, 1.0]
        });
        let (joints, weights): (Vec<_>, Vec<_>) = places.iter().map(|&place| skin(place)).unzip();
        let (uvs, colours): (Vec<_>, Vec<_>) = (uvs.collect(), colours.collect());
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
            .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colours)
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
            .with_inserted_indices(Indices::U32(indices))
            .with_computed_normals()
    }

    /// The angle of a column in radians, round the body from its right side (+X) over its back (+Z).
    fn angle(&self, column: f32) -> f32 {
        -FRAC_PI_2 + 0.5 * self.opening + (TAU - self.opening) * column / self.columns as f32
    }

    /// True if an arm goes through this square.
    fn is_armhole(&self, column: usize, row: usize) -> bool {
        let angle = self.angle(column as f32 + 0.5);
        let to_side = angle.abs().min((angle - PI).abs());
        self.armholes.0.contains(&row) && to_side < self.armholes.1
    }

    /// The corner of a square.
    fn place(&self, column: usize, row: usize) -> Vec3 {
        let length = |ends: &[Ring]| {
            let [[_, _, r, y], [_, _, s, z]] = [ends[0], ends[1]];
            (r - s).hypot(y - z)
        };
        let mut along = self.rings.windows(2).map(length).sum::<f32>() * row as f32 / self.rows as f32;
        let mut between = 0;
        while between + 2 < self.rings.len() && along > length(&self.rings[between..]) {
            along -= length(&self.rings[between..]);
            between += 1;
        }
        let part = along / length(&self.rings[between..]);
        let [above, below] = [self.rings[between], self.rings[between + 1]];
        let [side, side_height, front, front_height] =
            core::array::from_fn(|i| above[i] + (below[i] - above[i]) * part);
        let (sin, cos) = self.angle(column as f32).sin_cos();
        let height = front_height + (side_height - front_height) * cos * cos;
        // Up on the shoulders, out below them.
        let out = self.offset * (1.0 - 0.5 * ((height - 1.4) / 0.1).clamp(0.0, 1.0));
        let up = self.offset * ((height - 1.4) / 0.1).clamp(0.0, 1.0);
        Vec3::new((side + out) * cos, height + up, (front + out) * sin)
    }
}

/// The joints of a vertex and their weights: by height, and below the hips by side.
fn skin(place: Vec3) -> ([u16; 4], [f32; 4]) {
    let part = |from: f32, to: f32| ((place.y - from) / (to - from)).clamp(0.0, 1.0);
    let moves = if place.y > WAIST {
        let chest = part(WAIST, 1.3);
        [(CHEST, chest), (SPINE, 1.0 - chest), (HIPS, 0.0), (HIPS, 0.0)]
    } else {
        let (spine, thighs) = (part(1.0, WAIST), 0.6 * (1.0 - part(0.5, 0.95)));
        let left = 0.5 - 2.5 * place.x.clamp(-0.2, 0.2);
        let [one, other] = [(THIGHS[0], thighs * left), (THIGHS[1], thighs * (1.0 - left))];
        [(SPINE, spine), (HIPS, 1.0 - spine - thighs), one, other]
    };
    (moves.map(|(joint, _)| joint as u16), moves.map(|(_, weight)| weight))
}
