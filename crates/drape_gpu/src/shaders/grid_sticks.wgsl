// One iteration of all sticks of a large grid in one dispatch. Each workgroup loads a tile with a halo around it, projects all families
// of sticks in shared memory, and writes the tile's inner part:
//
//     +-----------------+      The halo is as wide as the ways on which one iteration can carry a change: the inner part
//     |      halo       |      gets the same positions as from batches over the whole grid, however the tiles lie.
//     |   +---------+   |
//     |   |  inner  |   |      Tiles read `positions` and write `next_positions`, so that none sees what another has done.
//     |   +---------+   |
//     +-----------------+

const HALO: u32 = {HALO}u;
const INNER: vec2u = vec2u(TILE_WIDTH, TILE_HEIGHT) - 2u * HALO;

@group(1) @binding(1) var<storage, read_write> next_positions: array<vec4f>;

var<workgroup> places: array<vec4f, TILE_WIDTH * TILE_HEIGHT>;

// The place where the k-th stick of a half of a family begins, along the axis by which the family is split. Sticks are one or two
// places long there.
fn start_of(k: u32, length: u32, phase: u32) -> u32 {
    // The tile begins a halo before a multiple of four places.
    if length == 1u {
        return 2u * k + (phase + HALO) % 2u;
    }
    return 2u * (k & ~1u) + 2u * ((phase + HALO / 2u) % 2u) + (k & 1u);
}

// Sticks whose start is in these rows of the tile.
fn project_batch(batch: Batch, thread: u32, rows: vec2u, least: vec2i, most: vec2i, is_square_root_free: bool) {
    let offset = vec2i(batch.right, batch.down);
    let is_along_row = batch.down == 0;
    // Along a row half of the places are starts; else all places of half of the rows.
    let first = select(rows.x / 4u * 2u * TILE_WIDTH, rows.x * (TILE_WIDTH / 2u), is_along_row);
    let end = select((rows.y + 3u) / 4u * 2u * TILE_WIDTH, rows.y * (TILE_WIDTH / 2u), is_along_row);
    for (var k = first + thread; k < end; k += WORKGROUP) {
        var start: vec2u;
        if is_along_row {
            start = vec2u(start_of(k % (TILE_WIDTH / 2u), u32(batch.right), batch.phase), k / (TILE_WIDTH / 2u));
        } else {
            start = vec2u(k % TILE_WIDTH, start_of(k / TILE_WIDTH, u32(batch.down), batch.phase));
        }
        let start_place = vec2i(start);
        let end_place = start_place + offset;
        let is_inside = all(min(start_place, end_place) >= least) && all(max(start_place, end_place) < most);
        if is_inside {
            let a = start.y * TILE_WIDTH + start.x;
            let b = u32(i32(a) + offset.y * i32(TILE_WIDTH) + offset.x);
            let p = places[a];
            let q = places[b];
            let pull = stick_pull(p, q, batch.rest_length, batch.stiffness, 0, is_square_root_free);
            places[a] = vec4f(p.xyz + pull * p.w, p.w);
            places[b] = vec4f(q.xyz - pull * q.w, q.w);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn project_grid(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let body = bodies[dispatch.body];
    let is_square_root_free = body.is_square_root_free != 0u;
    let origin = vec2i(group.xy * INNER) - vec2i(i32(HALO));
    let size = vec2i(i32(body.columns), i32(body.rows));
    // The part of the tile that lies on the grid.
    let least = max(vec2i(0), -origin);
    let most = min(vec2i(i32(TILE_WIDTH), i32(TILE_HEIGHT)), size - origin);
    for (var i = thread; i < TILE_WIDTH * TILE_HEIGHT; i += WORKGROUP) {
        let local = vec2i(i32(i % TILE_WIDTH), i32(i / TILE_WIDTH));
        if all(local >= least) && all(local < most) {
            let place = origin + local;
            places[i] = positions[body.first_particle + u32(place.y) * body.columns + u32(place.x)];
        }
    }
    workgroupBarrier();
    // The farther the iteration, the fewer rows of the halo can still reach the inner part.
    var reach = HALO;
    for (var i = 0u; i < body.batch_count; i++) {
        let index = select(i, body.batch_count - 1u - i, dispatch.iteration % 2u == 1u);
        let batch = batches[body.first_batch + index];
        let rows = vec2u(HALO - reach, TILE_HEIGHT - HALO + reach);
        project_batch(batch, thread, rows, least, most, is_square_root_free);
        reach -= u32(batch.down);
        workgroupBarrier();
    }
    for (var i = thread; i < INNER.x * INNER.y; i += WORKGROUP) {
        let local = vec2i(i32(i % INNER.x + HALO), i32(i / INNER.x + HALO));
        if all(local < most) {
            let place = origin + local;
            let index = u32(place.y) * body.columns + u32(place.x);
            let here = places[u32(local.y) * TILE_WIDTH + u32(local.x)];
            var position = here.xyz;
            if here.w > 0.0 {
                position = held_by_tethers(position, index, body);
            }
            next_positions[body.first_particle + index] = vec4f(position, here.w);
        }
    }
}
