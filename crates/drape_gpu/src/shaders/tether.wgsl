// Tethers: `tether.rs` of the solver has the same formula. A kernel says where positions are by its `position_of`.

// The position that a particle gets from its tethers: within the length of each from its pin, but moved by no more than
// `tether_pull` metres at once. `index` counts from the body's first particle.
fn held_by_tethers(start: vec3f, index: u32, body: Body) -> vec3f {
    var position = start;
    for (var tie = 0u; tie < body.tethers_per_particle; tie++) {
        let tether = pairs[body.first_tether + tie * body.particle_count + index];
        if tether.x == NONE {
            break;
        }
        let pin = position_of(body, tether.x);
        let length = bitcast<f32>(tether.y);
        let delta = position - pin.xyz;
        let distance_squared = dot(delta, delta);
        if pin.w == 0.0 && distance_squared > length * length {
            // It is longer than its rest length, so the denominator is above zero.
            let error = stick_error(distance_squared, length, body.is_square_root_free != 0u);
            var part = error.x / error.y;
            if part * part * distance_squared > body.tether_pull * body.tether_pull {
                part = body.tether_pull / sqrt(distance_squared);
            }
            position -= delta * part;
        }
    }
    return position;
}
