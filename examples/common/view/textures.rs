//! Textures made in code: nothing to load, nothing to licence.

use core::f32::consts::{PI, TAU};

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

/// Stripes of the curtain, across half a metre of cloth: start, end (parts of the period) and sRGB colour.
const STRIPES: [(f32, f32, [f32; 3]); 4] = [
    (0.00, 0.10, [0.93, 0.80, 0.58]),
    (0.14, 0.17, [0.86, 0.62, 0.28]),
    (0.83, 0.86, [0.86, 0.62, 0.28]),
    (0.90, 1.00, [0.93, 0.80, 0.58]),
];
const FABRIC: [f32; 3] = [0.56, 0.15, 0.14];
const HEM: [f32; 3] = [0.34, 0.09, 0.10];
/// Periods of the stripes across the curtain.
const STRIPE_PERIODS: f32 = 8.0;

/// Striped, woven cloth: the stripes show how it turns, faint cross threads how it folds.
pub fn fabric() -> Image {
    with_mips(1024, 768, |u, v| {
        let across = (u * STRIPE_PERIODS).fract();
        let mut colour = FABRIC;
        for (start, end, stripe) in STRIPES {
            let inside =
                smooth(start - 0.008, start + 0.008, across) * smooth(end + 0.008, end - 0.008, across);
            colour = mix(colour, stripe, inside);
        }
        // A seam along the lower edge and a thread every 12 cm.
        colour = mix(colour, HEM, smooth(0.955, 0.96, v));
        let thread = (v * 25.0).fract();
        colour = mix(colour, HEM, 0.35 * smooth(0.06, 0.03, (thread - 0.5).abs()));
        let weave = (u * 256.0 * TAU).sin() * (v * 192.0 * TAU).sin();
        colour.map(|part| part * (1.0 + 0.05 * weave))
    })
}

/// Dark iron with light bands from pole to pole, so that spin is seen.
pub fn ball() -> Image {
    with_mips(256, 128, |u, v| {
        let iron = [0.20, 0.21, 0.23];
        let band = ((u * 4.0).fract() - 0.5).abs();
        let colour = mix(iron, [0.78, 0.74, 0.66], smooth(0.12, 0.09, band));
        mix(colour, [0.70, 0.26, 0.12], smooth(0.07, 0.05, (v - 0.5).abs()))
    })
}

/// The sky from the zenith down to `horizon`, which it has from the horizon on.
pub fn sky(horizon: Srgba) -> Image {
    let zenith = [0.27, 0.46, 0.75];
    let horizon = [horizon.red, horizon.green, horizon.blue];
    with_mips(4, 256, |_, v| mix(zenith, horizon, (v * 2.0).min(1.0).powf(0.9)))
}

/// Threads across a piece of cloth, and from one thick thread to the next.
const THREADS: f32 = 128.0;
const THICK_THREAD: f32 = 16.0;

/// Grey cloth, to be multiplied by a colour: threads that pass over and under each other, every sixteenth a thick one, so that
/// stretch and folds are seen. With a hem and its stitches all round if it `has_hem`; else it can be repeated.
pub fn weave(has_hem: bool) -> Image {
    with_mips(1024, 1024, move |u, v| {
        let (x, y) = (u * THREADS, v * THREADS);
        let is_over = (x.floor() + y.floor()) as i32 % 2 == 0;
        // A thread is round, and dives under its neighbours at both ends.
        let (across, along) = if is_over { (x.fract(), y.fract()) } else { (y.fract(), x.fract()) };
        let height = (PI * across).sin() * (0.4 + 0.6 * (PI * along).sin());
        let mut grey = 0.82 + 0.20 * height;
        let thick = |x: f32| smooth(1.4, 0.6, (x % THICK_THREAD - 0.5 * THICK_THREAD).abs());
        grey *= 1.0 - 0.05 * thick(x).max(thick(y));
        if has_hem {
            let edge = u.min(1.0 - u).min(v.min(1.0 - v));
            let stitch =
                smooth(0.002, 0.001, (edge - 0.022).abs()) * smooth(-0.3, 0.3, (0.5 * PI * (x + y)).sin());
            grey *= 1.0 - 0.14 * smooth(0.027, 0.025, edge) - 0.25 * stitch;
        }
        [grey; 3]
    })
}

/// Grey rope of three strands, once round and as far along as it is to be repeated.
pub fn strands() -> Image {
    with_mips(128, 128, |u, v| {
        let strand = (3.0 * u + v).fract();
        let fibre = (TAU * (9.0 * u - 12.0 * v)).sin();
        [0.45 + 0.60 * (PI * strand).sin().powf(0.6) + 0.04 * fibre; 3]
    })
}

/// A grey beach ball as seen along its axis, to be multiplied by a colour: six gores around a button, darker towards the rim.
pub fn beach_ball() -> Image {
    with_mips(512, 512, |u, v| {
        let at = Vec2::new(u - 0.5, v - 0.5) * 2.0;
        let radius = at.length();
        let gore = (3.0 * at.y.atan2(at.x) / PI).rem_euclid(2.0);
        // Blurred by one part in fifty of the radius, so that all seams look alike.
        let blur = 0.02 / radius.max(0.02);
        let light = smooth(0.0, blur, gore.min(2.0 - gore)) * smooth(0.0, blur, (gore - 1.0).abs());
        let gores = if gore < 1.0 { 1.0 } else { 0.55 };
        let grey = mix([0.4; 3], [gores; 3], 0.5 + 0.5 * light);
        let grey = mix([1.0; 3], grey, smooth(0.13, 0.15, radius));
        grey.map(|part| part * (1.0 - 0.45 * radius.min(1.0).powi(3)))
    })
}

/// Tiles along each side of [`tiles`].
pub const TILES: f32 = 4.0;

/// Grey square tiles with joints, each a little lighter or darker than the next, with the grain of stone.
pub fn tiles() -> Image {
    const SIDE: u32 = 1024;
    let mut image = with_mips(SIDE, SIDE, |u, v| {
        let (x, y) = (u * TILES, v * TILES);
        let shade = hash(x as u32 + 17 * y as u32);
        let cell = |size: f32| hash((u * size) as u32 * 7919 + (v * size) as u32 * 104_729 + size as u32);
        let grain = 0.5 * cell(256.0) + 0.3 * cell(512.0) + 0.2 * cell(1024.0);
        let joint = |x: f32| smooth(0.010, 0.005, x.fract().min(1.0 - x.fract()));
        let grey = 0.88 + 0.07 * (shade - 0.5) + 0.05 * (grain - 0.5);
        [grey * (1.0 - 0.32 * joint(x).max(joint(y))); 3]
    });
    // Seen almost from the side.
    if let ImageSampler::Descriptor(sampler) = &mut image.sampler {
        sampler.set_anisotropic_filter(8);
    }
    image
}

/// The normals of small waves on water, to be repeated.
pub fn ripples() -> Image {
    // Waves across, waves along, height: whole numbers, so that the edges fit together.
    const WAVES: [(f32, f32, f32); 7] = [
        (1.0, 2.0, 0.05),
        (2.0, -1.0, 0.04),
        (3.0, 4.0, 0.04),
        (-5.0, 3.0, 0.03),
        (7.0, 2.0, 0.03),
        (4.0, -9.0, 0.03),
        (11.0, 8.0, 0.02),
    ];
    let mut image = with_mips(256, 256, |u, v| {
        let slope = |weight: fn(f32, f32) -> f32| {
            let wave = |(i, &(x, y, height)): (usize, &(f32, f32, f32))| {
                weight(x, y).signum() * height * (TAU * (x * u + y * v) + 2.4 * i as f32).cos()
            };
            WAVES.iter().enumerate().map(wave).sum::<f32>()
        };
        [0.5 + 0.5 * slope(|x, _| x), 0.5 + 0.5 * slope(|_, y| y), 1.0]
    });
    // They are numbers, not colours.
    image.texture_descriptor.format = TextureFormat::Rgba8Unorm;
    image
}

/// A number from 0 to 1 that looks as if by chance.
fn hash(seed: u32) -> f32 {
    let mixed = (seed ^ (seed >> 16)).wrapping_mul(0x7feb_352d);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x846c_a68b);
    (mixed ^ (mixed >> 16)) as f32 / u32::MAX as f32
}

/// 0 below `from`, 1 above `to`, smooth between; falling if `to` is the smaller one.
fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn mix(a: [f32; 3], b: [f32; 3], part: f32) -> [f32; 3] {
    core::array::from_fn(|i| a[i] + (b[i] - a[i]) * part)
}

/// An image of `width` x `height` texels (powers of two or their multiples), sRGB `colour` at (u, v), with all its
/// smaller copies, so that it does not flicker from afar.
fn with_mips(width: u32, height: u32, colour: impl Fn(f32, f32) -> [f32; 3]) -> Image {
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let [r, g, b] = colour((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let byte = |part: f32| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
        [byte(r), byte(g), byte(b), 255]
    };
    let mut level: Vec<[u8; 4]> = (0..width * height).map(texel).collect();
    let mut data = level.as_flattened().to_vec();
    let (mut columns, mut rows, mut levels) = (width, height, 1);
    while columns > 1 && rows > 1 {
        level = halved(&level, columns);
        (columns, rows, levels) = (columns / 2, rows / 2, levels + 1);
        data.extend_from_slice(level.as_flattened());
    }
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new_uninit(size, TextureDimension::D2, TextureFormat::Rgba8UnormSrgb, usage);
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = levels;
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        ..ImageSamplerDescriptor::linear()
    });
    image
}

/// Half as many columns and rows, each texel the mean of four. An odd last row or column is left out.
fn halved(texels: &[[u8; 4]], columns: u32) -> Vec<[u8; 4]> {
    let columns = columns as usize;
    let mean = |corner: usize| {
        let four = [corner, corner + 1, corner + columns, corner + columns + 1].map(|i| texels[i]);
        core::array::from_fn(|i| (four.iter().map(|texel| u32::from(texel[i])).sum::<u32>() / 4) as u8)
    };
    let rows = texels.len() / columns;
    let corners =
        (0..rows / 2).flat_map(|row| (0..columns / 2).map(move |column| 2 * (row * columns + column)));
    corners.map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_smaller_copy_is_the_mean_of_the_larger_one() {
        let image = with_mips(4, 2, |u, _| if u < 0.5 { [0.0; 3] } else { [1.0; 3] });
        assert_eq!(image.texture_descriptor.mip_level_count, 2);
        let data = image.data.expect("made above");
        assert_eq!(data.len(), 4 * (4 * 2 + 2));
        assert_eq!(data[32..], [0, 0, 0, 255, 255, 255, 255, 255]);
    }
}
