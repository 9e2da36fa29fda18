//! What things are made of, to look at: woven cloth, rope of three strands, jelly, tiles, water.

use bevy::math::Affine2;
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::view::shape_meshes::{PLANE, solid};
use crate::view::textures;

/// Textures that all bodies share. They are grey, and take the colour of the body.
#[derive(Resource)]
pub struct Surfaces {
    hemmed: Handle<Image>,
    weave: Handle<Image>,
    strands: Handle<Image>,
    beach_ball: Handle<Image>,
    tiles: Handle<Image>,
    ripples: Handle<Image>,
}

impl FromWorld for Surfaces {
    fn from_world(world: &mut World) -> Self {
        let mut images = world.resource_mut::<Assets<Image>>();
        Self {
            hemmed: images.add(textures::weave(true)),
            weave: images.add(textures::weave(false)),
            strands: images.add(textures::strands()),
            beach_ball: images.add(textures::beach_ball()),
            tiles: images.add(textures::tiles()),
            ripples: images.add(textures::ripples()),
        }
    }
}

impl Surfaces {
    /// Cloth with a hem, whose texture coordinates go from 0 to 1.
    pub fn cloth(&self, colour: Color) -> StandardMaterial {
        fabric(colour, self.hemmed.clone(), Affine2::IDENTITY)
    }

    /// Cloth of any shape.
    pub fn cloth_mesh(&self, colour: Color) -> StandardMaterial {
        // Once round a ball or a skirt is about twice as long as from top to bottom.
        fabric(colour, self.weave.clone(), Affine2::from_scale(Vec2::new(2.0, 1.0)))
    }

    /// A rope that is drawn as a tube.
    pub fn rope(&self, colour: Color, rope: &Rope, tube: &RopeMesh) -> StandardMaterial {
        // A strand goes round within about six radii.
        let turns = rope.start.distance(rope.end) / (6.0 * tube.radius.max(1e-3));
        fabric(colour, self.strands.clone(), Affine2::from_scale(Vec2::new(1.0, turns.max(1.0).round())))
    }

    /// A ball of jelly in a plane.
    pub fn soft_ball(&self, colour: Color) -> StandardMaterial {
        StandardMaterial { base_color_texture: Some(self.beach_ball.clone()), ..jelly(colour) }
    }

    /// The ground without a colour of its own, in tiles of a metre, to tell how large things are.
    pub fn ground(&self, colour: Color) -> StandardMaterial {
        let times = PLANE / textures::TILES;
        StandardMaterial {
            base_color_texture: Some(self.tiles.clone()),
            uv_transform: Affine2::from_scale(Vec2::splat(times)),
            ..solid(colour)
        }
    }

    /// Ground that has a colour of its own: water.
    pub fn water(&self, colour: Color) -> StandardMaterial {
        StandardMaterial {
            normal_map_texture: Some(self.ripples.clone()),
            // A metre and a half from one wave to its like.
            uv_transform: Affine2::from_scale(Vec2::splat(PLANE / 1.5)),
            perceptual_roughness: 0.2,
            reflectance: 0.5,
            ..solid(colour)
        }
    }
}

fn fabric(colour: Color, texture: Handle<Image>, uv_transform: Affine2) -> StandardMaterial {
    StandardMaterial {
        base_color: colour,
        base_color_texture: Some(texture),
        uv_transform,
        perceptual_roughness: 0.8,
        reflectance: 0.25,
        // A little light comes through from behind.
        diffuse_transmission: 0.2,
        double_sided: true,
        cull_mode: None,
        ..default()
    }
}

/// Soft bodies: smooth and moist.
pub fn jelly(colour: Color) -> StandardMaterial {
    StandardMaterial {
        base_color: colour,
        perceptual_roughness: 0.4,
        reflectance: 0.3,
        // Light goes in, and comes out on the other side.
        diffuse_transmission: 0.35,
        clearcoat: 0.2,
        clearcoat_perceptual_roughness: 0.1,
        double_sided: true,
        cull_mode: None,
        ..default()
    }
}
