// Sticks: `projection.rs` of the solver has the same formulas.

// The relative error of a stick or tether: with a square root, or without (Jakobsen 2001, section 5).
fn stick_error(length_squared: f32, rest_length: f32, is_square_root_free: bool) -> f32 {
    if is_square_root_free {
        let rest_squared = rest_length * rest_length;
        return (length_squared - rest_squared) / (length_squared + rest_squared);
    }
    let length = sqrt(length_squared);
    return select(0.0, (length - rest_length) / length, length > 0.0);
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
    let length_squared = dot(delta, delta);
    // The error as a fraction, so that one division does for it and the weights.
    var excess: f32;
    var whole: f32;
    if is_square_root_free {
        let rest_squared = rest_length * rest_length;
        excess = length_squared - rest_squared;
        whole = length_squared + rest_squared;
    } else {
        whole = sqrt(length_squared);
        excess = whole - rest_length;
    }
    let divisor = whole * (p.w + q.w);
    let acts = divisor > 0.0 && excess * f32(side) >= 0.0;
    return delta * select(0.0, excess * stiffness / divisor, acts);
}
