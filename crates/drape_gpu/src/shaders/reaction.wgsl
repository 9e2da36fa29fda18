// Reactions: the opposite of every push that contacts and friction give to particles, for obstacles that ask. A push changes a
// displacement by `d`, and so the momentum by `m d / h` with the substep `h`.

// Sums are integers of 64 bits, of so many a newton second, in which no order of threads can change them.
const IMPULSE_UNITS: f32 = {IMPULSE_UNITS};
const TWO_TO_32: f32 = 4294967296.0;

// Adds a number to the sum whose lower word is at `word`.
fn add_exactly(word: u32, value: f32) {
    let size = round(abs(value) * IMPULSE_UNITS);
    var high = u32(size / TWO_TO_32);
    var low = u32(size - f32(high) * TWO_TO_32);
    if value < 0.0 {
        high = ~high + u32(low == 0u);
        low = ~low + 1u;
    }
    let before = atomicAdd(&reactions[word], low);
    high += u32(before + low < before);
    if high != 0u {
        atomicAdd(&reactions[word + 1u], high);
    }
}

// Notes that an obstacle has changed the displacement of a particle at `position`.
fn note_push(index: u32, change: vec3f, position: vec3f, inverse_mass: f32, body: Body) {
    if !HAS_EXTRAS || obstacles[index].is_asking == 0u {
        return;
    }
    let impulse = -change / (body.substep * inverse_mass);
    let moment = cross(position + body.origin - obstacles[index].end, impulse);
    for (var axis = 0u; axis < 3u; axis++) {
        add_exactly(12u * index + 2u * axis, impulse[axis]);
        add_exactly(12u * index + 6u + 2u * axis, moment[axis]);
    }
}
