//! The sources of the shaders: parts of WGSL, joined, with the sizes and constants that the processor decides.

use drape_solver::constants::{CONTACT_MARGIN, LEAST_OVERLAP, MAX_MAGNITUDE, PUSH_OUT_SPEED, REFERENCE_STEP};
use drape_solver::motion::wind::WAVES;

/// The greatest number of obstacles in a step: one bit each in a workgroup's shared memory.
pub const MAX_OBSTACLES: usize = 1024;

/// Units of the sums of reactions in a newton second, or a newton metre second.
pub(crate) const IMPULSE_UNITS: f32 = 1_073_741_824.0;

/// Columns or rows on which one iteration over a grid may carry a change.
pub(crate) const HALO: u32 = 10;

/// Bodies that one workgroup steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SizeClass {
    /// The most particles.
    pub particles: u32,
    /// Threads of a workgroup: as many as finish soonest.
    pub threads: u32,
    /// Threads where a crowd of bodies waits for a place on the device: as many as need the least of it.
    pub threads_in_crowd: u32,
}

impl SizeClass {
    const fn new(particles: u32, threads: u32) -> Self {
        Self { particles, threads, threads_in_crowd: threads }
    }
}

/// Sizes of bodies that one workgroup steps, the smallest first.
pub(crate) const SIZE_CLASSES: [SizeClass; 5] = [
    SizeClass::new(64, 64),
    SizeClass::new(128, 64),
    SizeClass { threads_in_crowd: 64, ..SizeClass::new(256, 128) },
    SizeClass::new(512, 256),
    SizeClass::new(1024, 256),
];

/// Threads of a workgroup that steps a part of a large body.
pub(crate) const LARGE_WORKGROUP: u32 = 256;

/// Threads of a workgroup that writes vertices, or targets of pins.
pub(crate) const LIST_WORKGROUP: u32 = 64;

/// Columns and rows of tiles of a grid, the largest first: the shared memory of a device decides. Without their halo they have a multiple of
/// four.
pub(crate) const TILES: [[u32; 2]; 2] = [[64, 44], [64, 32]];

/// Threads of a tile's workgroup, where the device allows as many.
pub(crate) const TILE_WORKGROUP: u32 = 1024;

const INVOCATION: &str = include_str!("shaders/invocation.wgsl");
const STRUCTURES: &str = include_str!("shaders/structures.wgsl");
const STICK: &str = include_str!("shaders/stick.wgsl");
const AIR: &str = include_str!("shaders/air.wgsl");
const OBSTACLE: &str = include_str!("shaders/obstacle.wgsl");
const NEARBY: &str = include_str!("shaders/nearby.wgsl");
const TETHER: &str = include_str!("shaders/tether.wgsl");
const DISPATCH: &str = include_str!("shaders/dispatch.wgsl");
const OWN_POSITIONS: &str = include_str!("shaders/own_positions.wgsl");
const REACTION: &str = include_str!("shaders/reaction.wgsl");
const SMALL: &str = include_str!("shaders/small_bodies.wgsl");
const LARGE: &str = include_str!("shaders/large_bodies.wgsl");
const PINS: &str = include_str!("shaders/pins.wgsl");
const VERTICES: &str = include_str!("shaders/vertices.wgsl");
const SURFACE: &str = include_str!("shaders/surface.wgsl");
const TUBE: &str = include_str!("shaders/tube.wgsl");
const GRID: &str = include_str!("shaders/grid_sticks.wgsl");

/// Features of a kernel that few scenes use. Their code costs registers even if it does not run: a crowd of small bodies is a third slower with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extras {
    None,
    /// Obstacles with a field of distances, and those that ask for their reactions.
    FieldsAndReactions,
}

impl Extras {
    fn source(self) -> &'static str {
        match self {
            Self::None => "const HAS_EXTRAS: bool = false;\n",
            Self::FieldsAndReactions => "const HAS_EXTRAS: bool = true;\n",
        }
    }
}

/// The whole source of the kernel of bodies of up to so many particles.
pub(crate) fn small_source(particles: u32, threads: u32, extras: Extras) -> String {
    let per_thread = particles.div_ceil(threads);
    let sizes = format!("const WORKGROUP: u32 = {threads}u;\nconst PER_THREAD: u32 = {per_thread}u;\n");
    with_constants(&[
        &sizes,
        extras.source(),
        INVOCATION,
        STRUCTURES,
        STICK,
        TETHER,
        AIR,
        REACTION,
        OBSTACLE,
        NEARBY,
        SMALL,
    ])
}

/// The whole source of the kernels of large bodies.
pub(crate) fn large_source(extras: Extras) -> String {
    let sizes = format!("const WORKGROUP: u32 = {LARGE_WORKGROUP}u;\n");
    with_constants(&[
        &sizes,
        extras.source(),
        INVOCATION,
        STRUCTURES,
        DISPATCH,
        OWN_POSITIONS,
        STICK,
        TETHER,
        AIR,
        REACTION,
        OBSTACLE,
        NEARBY,
        LARGE,
    ])
}

/// The whole source of the kernel that writes the vertices of surfaces.
pub(crate) fn surface_source() -> String {
    list_source(&[VERTICES, SURFACE])
}

/// The whole source of the kernel that writes the vertices of tubes.
pub(crate) fn tube_source() -> String {
    list_source(&[VERTICES, TUBE])
}

/// The whole source of the kernel that hands targets to pins.
pub(crate) fn pin_source() -> String {
    list_source(&[PINS])
}

fn list_source(parts: &[&str]) -> String {
    let size = format!("const WORKGROUP: u32 = {LIST_WORKGROUP}u;\n");
    with_constants(&[&[size.as_str(), INVOCATION], parts].concat())
}

/// The whole source of the kernel of tiles.
pub(crate) fn grid_source([width, height]: [u32; 2], threads: u32) -> String {
    let sizes = format!(
        "const WORKGROUP: u32 = {threads}u;\nconst TILE_WIDTH: u32 = {width}u;\nconst TILE_HEIGHT: u32 = {height}u;\n"
    );
    with_constants(&[&sizes, STRUCTURES, DISPATCH, OWN_POSITIONS, STICK, TETHER, GRID])
}

/// Joins parts of a source, and fills in the constants that the solver has too.
fn with_constants(parts: &[&str]) -> String {
    let words = MAX_OBSTACLES.div_ceil(32);
    parts
        .concat()
        .replace("{WAVES}", &format!("{WAVES}"))
        .replace("{LEAST_OVERLAP}", &format!("{LEAST_OVERLAP:?}"))
        .replace("{REFERENCE_STEP}", &format!("{REFERENCE_STEP:?}"))
        .replace("{IMPULSE_UNITS}", &format!("{IMPULSE_UNITS:?}"))
        .replace("{MAX_MAGNITUDE}", &format!("{MAX_MAGNITUDE:?}"))
        .replace("{PUSH_OUT_SPEED}", &format!("{PUSH_OUT_SPEED:?}"))
        .replace("{CONTACT_MARGIN}", &format!("{CONTACT_MARGIN:?}"))
        .replace("{OBSTACLE_WORDS}", &format!("{words}u"))
        .replace("{HALO}", &HALO.to_string())
}

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    const ALL_EXTRAS: [Extras; 2] = [Extras::None, Extras::FieldsAndReactions];

    /// All sources are valid WGSL within WebGPU: nothing here needs an adapter.
    #[test]
    fn every_kernel_is_valid() {
        let small = ALL_EXTRAS.into_iter().flat_map(|extras| {
            SIZE_CLASSES.into_iter().flat_map(move |class| {
                [class.threads, class.threads_in_crowd]
                    .map(|threads| small_source(class.particles, threads, extras))
            })
        });
        let large = ALL_EXTRAS.map(large_source);
        let grids = TILES.map(|tile| grid_source(tile, TILE_WORKGROUP));
        for source in small.chain(large).chain(grids).chain([surface_source(), tube_source(), pin_source()]) {
            let module = naga::front::wgsl::parse_str(&source)
                .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            validator.validate(&module).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
        }
    }

    /// A tile without its halo has a multiple of four columns and rows, as the families of sticks repeat after four places.
    #[test]
    fn tiles_begin_where_families_repeat() {
        for [width, height] in TILES {
            assert!((width - 2 * HALO).is_multiple_of(4) && (height - 2 * HALO).is_multiple_of(4));
            assert!(width.is_multiple_of(4) && height.is_multiple_of(4));
        }
    }
}
