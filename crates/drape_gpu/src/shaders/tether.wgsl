// Tethers of a body whose pins lie in the buffer of positions.

// The position that a particle gets from its tethers. `index` counts from the body's first particle.
fn held_by_tethers(start: vec3f, index: u32, body: Body) -> vec3f {
    var position = start;
    for (var tie = 0u; tie < body.tethers_per_particle; tie++) {
        let tether = pairs[body.first_tether + tie * body.particle_count + index];
        if tether.x == NONE {
            break;
        }
        let anchor = positions[body.first_particle + tether.x];
        if anchor.w == 0.0 {
            let length = bitcast<f32>(tether.y);
            position = tethered(position, anchor.xyz, length, body.tether_pull, body.is_square_root_free != 0u);
        }
    }
    return position;
}
