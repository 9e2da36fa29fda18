// The processor writes these, and all kernels read them: `layout.rs` has the same structures.

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
    waves: array<Wave, {WAVES}>,
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
    // 1 if its reactions are summed up.
    is_asking: u32,
    // Of a field: the sides of a cell in metres, the pair that holds the first two distances, and corners along each axis. Its least corner
    // is `size.xyz`; `size.w` is 1 if it goes on below.
    cell: vec3f,
    first_pair: u32,
    corners: vec3u,
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
    // 1 over the mass of all particles in 1/kg; 0 if some are pinned.
    inverse_mass: f32,
    // The substep in parts of that of the step before, for displacements.
    rescale: f32,
    // 1 if the air pushes on the squares of a grid, 0 if on faces and links.
    has_squares: u32,
    unused: u32,
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

// The processor may read it back. Coordinates are ordered integers.
struct Status {
    low: array<atomic<u32>, 3>,
    // 1 if a particle would not have been finite.
    is_broken: atomic<u32>,
    high: array<atomic<u32>, 3>,
    // Bits of the square of the greatest displacement in a substep, in square metres.
    fastest: atomic<u32>,
    // Drift of a free large body's centre of mass by rounding, for even and for odd substeps.
    drift: array<atomic<i32>, 6>,
    unused: array<u32, 2>,
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
// Pairs of words: sticks as (both ends, rest length), tethers as (pin, length), fans as (second corner, third corner), fields as two
// distances.
@group(0) @binding(4) var<storage, read> pairs: array<vec2u>;
// Position relative to the body's origin, and inverse mass.
@group(0) @binding(5) var<storage, read_write> positions: array<vec4f>;
// Displacement in the last substep; of a pinned particle with 1 in w, its target.
@group(0) @binding(6) var<storage, read_write> displacements: array<vec4f>;

// Maps floats to integers of the same order, whose minima and maxima no order of threads can change.
fn ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn unordered(key: u32) -> f32 {
    return bitcast<f32>(select(~key, key & 0x7fffffffu, (key & 0x80000000u) != 0u));
}

// Sticks cannot move the centre of mass of a free body: what they seem to move it by is rounding, in the same direction in substep after
// substep. Its sum is taken in integers of so many a metre, in which no order of threads can change it.
const DRIFT_UNITS: f32 = 4294967296.0;

// The part of a particle that sticks have moved in the drift of its body.
fn drift_by(moved: vec3f, inverse_mass: f32, body: Body) -> vec3i {
    let part = round(moved * (body.inverse_mass / inverse_mass * DRIFT_UNITS));
    // More than half a metre is no rounding.
    return select(vec3i(0), vec3i(part), abs(part) < vec3f(2147483520.0));
}

// Greatest coordinate that counts as finite, in metres: its square is far from the end of single precision.
const MAX_MAGNITUDE: f32 = {MAX_MAGNITUDE};

// Compares bits, as a shader may take it for granted that there are no infinities.
fn is_finite(v: vec3f) -> bool {
    let sizes = bitcast<vec3u>(v) & vec3u(0x7fffffffu);
    return all(sizes <= vec3u(bitcast<u32>(MAX_MAGNITUDE)));
}
