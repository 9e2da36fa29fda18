// Writes surfaces: one thread a vertex.

@compute @workgroup_size(WORKGROUP)
fn write_surface(invocation: Invocation) {
    let thread = invocation.thread;
    let number = number_of(invocation.group, invocation.groups);
    if number >= shares[0].x {
        return;
    }
    let share = shares[number + 1u];
    let surface = surfaces[share.x];
    let index = share.y + thread;
    if index >= surface.vertex_count {
        return;
    }
    var particle = index;
    if surface.first_vertex != NONE {
        particle = pairs[surface.first_vertex + index].x;
        if particle == NONE {
            return;
        }
    }
    let here = place_of(surface, particle);
    var sum = vec3f(0.0);
    let fan = pairs[surface.first_fan + index];
    for (var i = fan.x; i < fan.y; i++) {
        let corners = pairs[surface.first_fan + i];
        if corners.y != NONE {
            sum += cross(place_of(surface, corners.x) - here, place_of(surface, corners.y) - here);
        }
    }
    let normal = direction_of(sum) * surface.orientation;
    write_vertex(surface, index, here, select(vec3f(0.0, 0.0, 1.0), normal, any(normal != vec3f(0.0))));
}
