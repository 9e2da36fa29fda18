// The obstacles that the particles of a workgroup may touch in a step.

const OBSTACLE_WORDS: u32 = {OBSTACLE_WORDS};

// Threads side by side change places side by side: at one place they would wait for each other.
const LANES: u32 = 8u;

// Least and greatest coordinates of the workgroup's particles, as ordered integers in lanes for each axis; bits of the square of their
// greatest displacement.
var<workgroup> low: array<atomic<u32>, 3u * LANES>;
var<workgroup> high: array<atomic<u32>, 3u * LANES>;
var<workgroup> fastest: atomic<u32>;
var<workgroup> is_broken: atomic<u32>;
var<workgroup> near: array<atomic<u32>, OBSTACLE_WORDS>;

// To be called before a barrier.
fn clear_near(thread: u32) {
    if thread < 3u * LANES {
        atomicStore(&low[thread], 0xffffffffu);
        atomicStore(&high[thread], 0u);
    }
    if thread == 0u {
        atomicStore(&fastest, 0u);
        atomicStore(&is_broken, 0u);
    }
    for (var word = thread; word < OBSTACLE_WORDS; word += WORKGROUP) {
        atomicStore(&near[word], 0u);
    }
}

// Widens the box by a particle that may move so far in the step.
fn include(position: vec3f, way: f32, thread: u32) {
    for (var axis = 0u; axis < 3u; axis++) {
        let place = axis * LANES + thread % LANES;
        atomicMin(&low[place], ordered(position[axis] - way));
        atomicMax(&high[place], ordered(position[axis] + way));
    }
}

// Leaves the box in the first lane of each axis. To be called between two barriers.
fn merge_lanes(thread: u32) {
    if thread < 3u * LANES && thread % LANES != 0u {
        let first = thread / LANES * LANES;
        atomicMin(&low[first], atomicLoad(&low[thread]));
        atomicMax(&high[first], atomicLoad(&high[thread]));
    }
}

// Twice the way of a particle that nothing stops, because sticks pull it along with faster ones.
fn reach(displacement: vec3f, body: Body) -> f32 {
    let speed = length(displacement) / body.substep + length(step.gravity) * step.duration;
    return 2.0 * speed * step.duration + body.thickness + CONTACT_MARGIN;
}

// To be called between two barriers after lanes were merged.
fn find_near(thread: u32, body: Body) {
    if thread >= step.obstacle_count {
        return;
    }
    var least: vec3f;
    var greatest: vec3f;
    for (var axis = 0u; axis < 3u; axis++) {
        least[axis] = body.origin[axis] + unordered(atomicLoad(&low[axis * LANES]));
        greatest[axis] = body.origin[axis] + unordered(atomicLoad(&high[axis * LANES]));
    }
    for (var i = thread; i < step.obstacle_count; i += WORKGROUP) {
        let obstacle = obstacles[i];
        let is_apart = any(obstacle.low > greatest) || any(obstacle.high < least);
        if !is_apart && interacts(body, obstacle) {
            atomicOr(&near[i / 32u], 1u << (i % 32u));
        }
    }
}

// The first near obstacle from this one on, or `NONE`.
fn next_near(first: u32) -> u32 {
    let word_count = (step.obstacle_count + 31u) / 32u;
    var wanted = 0xffffffffu << (first % 32u);
    for (var word = first / 32u; word < word_count; word++) {
        let bits = atomicLoad(&near[word]) & wanted;
        if bits != 0u {
            return 32u * word + firstTrailingBit(bits);
        }
        wanted = 0xffffffffu;
    }
    return NONE;
}

// True if a position may touch one of the near obstacles.
fn is_at_any(position: vec3f, body: Body) -> bool {
    for (var i = next_near(0u); i != NONE; i = next_near(i + 1u)) {
        if is_at(position, i, body) {
            return true;
        }
    }
    return false;
}

// Moves a particle out of all near obstacles, in their order. Returns the position.
fn pushed_out_of_near(
    start: vec3f,
    inverse_mass: f32,
    body: Body,
    substep: u32,
    flight: ptr<function, Flight>,
) -> vec3f {
    var position = start;
    for (var i = next_near(0u); i != NONE; i = next_near(i + 1u)) {
        position = pushed_out(position, inverse_mass, i, body, substep, flight);
    }
    return position;
}
