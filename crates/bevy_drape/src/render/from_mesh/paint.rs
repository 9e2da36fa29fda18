//! Numbers painted on the vertices of a mesh.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;

use crate::render::from_mesh::reading::MeshFault;

/// What is read from the vertices of a mesh, so that it can be painted in a modelling tool.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothPaint {
    /// Where it is said which vertices are pinned: those with a value above [`threshold`](Self::threshold). None: nowhere.
    pub pins: Option<PaintChannel>,
    /// The value above which a vertex is pinned; 0.5 by default.
    pub threshold: f32,
    /// Where it is said how far a vertex may be from where the animation has it: from its skinned pose, or from its place on the
    /// entity. Black is 0, which follows the animation; see [`full_distance`](Self::full_distance). None, the default: without limits.
    pub max_distance: Option<PaintChannel>,
    /// The distance, in metres, that a value of 1 stands for; 1 by default, 0 or more.
    pub full_distance: f32,
    /// Where it is said how stiff the cloth is: white as its fields say, the darker the softer. 0.9 makes a rigid edge 0.999 stiff, 0.5 makes
    /// it 0.89, black 0.5 ([`painted_stiffness`](MeshClothBuilder::painted_stiffness)). None, the default: alike everywhere.
    pub stiffness: Option<PaintChannel>,
    /// Whether vertex colours that something is read from are seen as well: renderers multiply the material's colour by them. False, the
    /// default: the mesh that shows the cloth has no colours then. Those that nothing is read from are always seen.
    pub is_seen: bool,
}

/// A number that each vertex of a mesh has.
#[derive(Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub enum PaintChannel {
    /// Red of the vertex colour. A mesh without colours has none.
    Red,
    /// Green, likewise.
    Green,
    /// Blue, likewise.
    Blue,
    /// Alpha, likewise.
    Alpha,
    /// The first number of the attribute with this name, which the mesh must have.
    Attribute(String),
}

impl PaintChannel {
    /// Whether it is of the vertex colours.
    pub(crate) fn is_colour(&self) -> bool {
        !matches!(self, Self::Attribute(_))
    }
}

impl ClothPaint {
    /// Whether vertex colours are paint, and nothing else.
    pub(crate) fn takes_colours(&self) -> bool {
        let channels = [&self.pins, &self.max_distance, &self.stiffness];
        !self.is_seen && channels.into_iter().flatten().any(PaintChannel::is_colour)
    }
}

impl Default for ClothPaint {
    fn default() -> Self {
        Self {
            pins: Some(PaintChannel::Red),
            threshold: 0.5,
            max_distance: None,
            full_distance: 1.0,
            stiffness: None,
            is_seen: false,
        }
    }
}

/// What is painted on the vertices; nothing on a mesh without colours.
pub(crate) fn paint(mesh: &Mesh, channel: &PaintChannel, vertices: usize) -> Result<Vec<f32>, MeshFault> {
    let (name, number) = match channel {
        PaintChannel::Red => (Mesh::ATTRIBUTE_COLOR.name, 0),
        PaintChannel::Green => (Mesh::ATTRIBUTE_COLOR.name, 1),
        PaintChannel::Blue => (Mesh::ATTRIBUTE_COLOR.name, 2),
        PaintChannel::Alpha => (Mesh::ATTRIBUTE_COLOR.name, 3),
        PaintChannel::Attribute(name) => (name.as_str(), 0),
    };
    let mut attributes = mesh.try_attributes().map_err(|_| MeshFault::NotInMainWorld)?;
    match (attributes.find(|(attribute, _)| attribute.name == name), channel) {
        (Some((_, values)), _) => {
            let numbers = numbers(values, number).filter(|numbers| numbers.len() == vertices);
            numbers.ok_or_else(|| MeshFault::NoNumbers(name.into()))
        }
        (None, PaintChannel::Attribute(_)) => Err(MeshFault::NoAttribute(name.into())),
        (None, _) => Ok(Vec::new()),
    }
}

/// The vertices on which `channel` is painted above `threshold`; none without a channel.
pub(crate) fn painted_above(
    mesh: &Mesh,
    channel: Option<&PaintChannel>,
    threshold: f32,
    vertices: usize,
) -> Result<impl Iterator<Item = u32> + use<>, MeshFault> {
    let painted = channel.map(|channel| paint(mesh, channel, vertices)).transpose()?.unwrap_or_default();
    Ok((0..).zip(painted).filter(move |&(_, value)| value > threshold).map(|(vertex, _)| vertex))
}

/// One number of each vertex, whole ones of eight or sixteen bits as parts of the greatest where that is what they stand for.
fn numbers(values: &VertexAttributeValues, number: usize) -> Option<Vec<f32>> {
    fn pick<T: Copy, const N: usize>(
        values: &[[T; N]],
        number: usize,
        float: impl Fn(T) -> f32,
    ) -> Option<Vec<f32>> {
        (number < N).then(|| values.iter().map(|value| float(value[number])).collect())
    }
    let part_of_255 = |value: u8| f32::from(value) / 255.0;
    let part_of_65535 = |value: u16| f32::from(value) / 65535.0;
    match values {
        VertexAttributeValues::Float32(values) if number == 0 => Some(values.clone()),
        VertexAttributeValues::Float32x2(values) => pick(values, number, f32::from),
        VertexAttributeValues::Float32x3(values) => pick(values, number, f32::from),
        VertexAttributeValues::Float32x4(values) => pick(values, number, f32::from),
        VertexAttributeValues::Unorm8x2(values) => pick(values, number, part_of_255),
        VertexAttributeValues::Unorm8x4(values) => pick(values, number, part_of_255),
        VertexAttributeValues::Unorm16x2(values) => pick(values, number, part_of_65535),
        VertexAttributeValues::Unorm16x4(values) => pick(values, number, part_of_65535),
        VertexAttributeValues::Uint8x2(values) => pick(values, number, f32::from),
        VertexAttributeValues::Uint8x4(values) => pick(values, number, f32::from),
        VertexAttributeValues::Uint16x2(values) => pick(values, number, f32::from),
        VertexAttributeValues::Uint16x4(values) => pick(values, number, f32::from),
        _ => None,
    }
}
