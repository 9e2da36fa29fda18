// Sticks: `projection.rs` of the solver has the same formulas.

// The relative error of a stick or tether as a fraction, numerator and denominator: with a square root, or without (Jakobsen 2001,
// section 5).
fn stick_error(length_squared: f32, rest_length: f32, is_square_root_free: bool) -> vec2f {
    if is_square_root_free {
        let rest_squared = rest_length * rest_length;
        return vec2f(length_squared - rest_squared, length_squared + rest_squared);
    }
    let length = sqrt(length_squared);
    return vec2f(length - rest_length, length);
}

// The vector by which the two ends move together, in parts of their shares of the inverse mass.
fn stick_pull(
    p: vec4f,
    q: vec4f,
    rest_length: f32,
    stiffness: f32,
    side: i32,
    is_square_root_free: bool,
) -> vec3f {
    let delta = q.xyz - p.xyz;
    let error = stick_error(dot(delta, delta), rest_length, is_square_root_free);
    // One division for the error and the weights.
    let divisor = error.y * (p.w + q.w);
    let acts = divisor > 0.0 && error.x * f32(side) >= 0.0;
    return delta * select(0.0, error.x * stiffness / divisor, acts);
}
