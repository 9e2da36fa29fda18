//! Numbers painted on the vertices of a mesh.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;

use crate::render::from_mesh::pose_paint::{BackstopPaint, PoseDrivePaint};
use crate::render::from_mesh::reading::MeshFault;

/// Channels that a cloth reads from the vertices of its mesh, to be painted in a modelling tool.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct ClothPaint {
    /// Pins vertices with a value above [`threshold`](Self::threshold). None: no painted pins.
    pub pins: Option<PaintChannel>,
    /// Value above which a vertex is pinned; 0.5 by default.
    pub threshold: f32,
    /// Limits the distance of a vertex from its animated position: from its skinned pose, or from its place on the
    /// entity. Black, 0, follows the animation exactly; 1 stands for [`full_distance`](Self::full_distance). None, the
    /// default: no limits.
    pub max_distance: Option<PaintChannel>,
    /// Distance in metres that a value of 1 stands for, 0 or more; 1 by default.
    pub full_distance: f32,
    /// Keeps vertices from sinking behind their animated positions. None, the default: no backstops.
    pub backstop: Option<BackstopPaint>,
    /// Draws vertices towards their animated positions. None, the default: no drives.
    pub pose_drive: Option<PoseDrivePaint>,
    /// Scales stiffness: white for the stiffness of the fields, darker for softer. On a rigid edge 0.9 gives 0.999, 0.5
    /// gives 0.89, black gives 0.5 ([`painted_stiffness`](drape_solver::MeshClothBuilder::painted_stiffness)). None, the default: the
    /// same stiffness everywhere.
    pub stiffness: Option<PaintChannel>,
    /// True to draw vertex colours that are read as paint: renderers multiply the material's colour by them. False, the
    /// default, removes them from the shown mesh. Colours that are not read are always drawn.
    pub is_seen: bool,
}

/// A number at each vertex of a mesh.
#[derive(Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub enum PaintChannel {
    /// Red of the vertex colour. Meshes without colours have no paint.
    Red,
    /// Green of the vertex colour.
    Green,
    /// Blue of the vertex colour.
    Blue,
    /// Alpha of the vertex colour.
    Alpha,
    /// First number of the attribute with this name, which the mesh must have.
    Attribute(String),
}

impl PaintChannel {
    /// True for a channel of the vertex colours.
    pub(crate) fn is_colour(&self) -> bool {
        !matches!(self, Self::Attribute(_))
    }
}

impl ClothPaint {
    /// True if vertex colours are paint only.
    pub(crate) fn takes_colours(&self) -> bool {
        let channels = [&self.pins, &self.stiffness].into_iter().flatten();
        !self.is_seen && channels.chain(self.pose_channels()).any(PaintChannel::is_colour)
    }
}

impl Default for ClothPaint {
    fn default() -> Self {
        Self {
            pins: Some(PaintChannel::Red),
            threshold: 0.5,
            max_distance: None,
            full_distance: 1.0,
            backstop: None,
            pose_drive: None,
            stiffness: None,
            is_seen: false,
        }
    }
}

/// Returns the numbers painted on the vertices; none for a mesh without colours.
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

/// Returns the vertices on which `channel` is painted above `threshold`; none without a channel.
pub(crate) fn painted_above(
    mesh: &Mesh,
    channel: Option<&PaintChannel>,
    threshold: f32,
    vertices: usize,
) -> Result<impl Iterator<Item = u32> + use<>, MeshFault> {
    let painted = channel.map(|channel| paint(mesh, channel, vertices)).transpose()?.unwrap_or_default();
    Ok((0..).zip(painted).filter(move |&(_, value)| value > threshold).map(|(vertex, _)| vertex))
}

/// Returns one number of each vertex. Normalized integers are scaled to 0 to 1.
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
