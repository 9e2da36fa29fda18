// What the processor writes, and all kernels read: `layout.rs` has the same structures.

struct Wave {
    // Radians per metre.
    number: vec3f,
    phase: f32,
    // Metres per second.
    amplitude: vec3f,
    unused: f32,
}

// The same for all bodies in one step.
struct Step {
    gravity: vec3f,
    duration: f32,
    wind: vec3f,
    // Half the density of the air times the drag coefficient, in kg/m^3.
    drag: f32,
    // The same with the lift coefficient.
    lift: f32,
    is_windy: u32,
    wave_count: u32,
    obstacle_count: u32,
    // The substep in parts of that of the step before, for displacements.
    rescale: f32,
    unused_a: f32,
    unused_b: f32,
    unused_c: f32,
    waves: array<Wave, 6>,
}

struct Obstacle {
    // The box around its whole way in the step.
    low: vec3f,
    shape: u32,
    high: vec3f,
    friction: f32,
    start: vec3f,
    static_friction: f32,
    end: vec3f,
    combine_rule: u32,
    start_rotation: vec4f,
    end_rotation: vec4f,
    size: vec4f,
    memberships: u32,
    filters: u32,
    is_moving: u32,
    unused: u32,
}

struct Body {
    // Positions of particles are kept relative to it.
    origin: vec3f,
    first_particle: u32,
    particle_count: u32,
    substeps: u32,
    iterations: u32,
    is_square_root_free: u32,
    first_batch: u32,
    batch_count: u32,
    first_tether: u32,
    tethers_per_particle: u32,
    // Index of the first pair of the list that tells where each particle's list of faces begins and ends.
    first_fan: u32,
    memberships: u32,
    filters: u32,
    thickness: f32,
    friction: f32,
    static_friction: f32,
    // Seconds.
    substep: f32,
    // The part of a displacement that drag leaves.
    decay: f32,
    // The displacement by an acceleration of 1 m/s^2 in a substep.
    gain: f32,
    // Greatest pull of a tether in one projection, in metres.
    tether_pull: f32,
    columns: u32,
    rows: u32,
}

// Sticks that share no particle.
struct Batch {
    // Index of the pair of the first stick.
    first: u32,
    count: u32,
    stiffness: f32,
    // 1 if the sticks act only when too long, -1 if only when too short, 0 if always.
    side: i32,
    // On a grid: from each start to the particle so many columns to the right and rows down.
    right: i32,
    down: i32,
    // On a grid: 0 if the sticks begin at even places, 1 if at odd ones.
    phase: u32,
    rest_length: f32,
}

struct Place {
    translation: vec3f,
    rotation: vec4f,
}

const NONE: u32 = 0xffffffffu;

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> obstacles: array<Obstacle>;
@group(0) @binding(2) var<storage, read> bodies: array<Body>;
@group(0) @binding(3) var<storage, read> batches: array<Batch>;
// Pairs of words: sticks as (both ends, rest length), tethers as (pin, length), fans as (second corner, third corner).
@group(0) @binding(4) var<storage, read> pairs: array<vec2u>;
// Position relative to the body's origin, and inverse mass.
@group(0) @binding(5) var<storage, read_write> positions: array<vec4f>;
// Displacement in the last substep. For a pinned particle, its target, and 1 if there is one.
@group(0) @binding(6) var<storage, read_write> displacements: array<vec4f>;

fn is_finite(v: vec3f) -> bool {
    let exponents = bitcast<vec3u>(v) & vec3u(0x7f800000u);
    return all(exponents != vec3u(0x7f800000u));
}
