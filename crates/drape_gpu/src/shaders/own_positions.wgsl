// Positions of a body that lie in the buffer of positions.

fn position_of(body: Body, index: u32) -> vec4f {
    return positions[body.first_particle + index];
}
