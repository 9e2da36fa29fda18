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

// The place of the k-th start of a family and the column where its stick ends. Along a row half of the places are starts; else all places
// of half of the rows.
fn stick_of(k: u32, batch: Batch, length: u32) -> vec2u {
    if batch.down == 0 {
        const HALF: u32 = TILE_WIDTH / 2u;
        let column = start_of(k % HALF, length, batch.phase);
        return vec2u(k / HALF * TILE_WIDTH + column, column + length);
    }
    let column = k % TILE_WIDTH;
    return vec2u(start_of(k / TILE_WIDTH, length, batch.phase) * TILE_WIDTH + column, column + u32(batch.right));
}

// Sticks of this length whose start is in these rows of the tile.
fn project_batch(batch: Batch, thread: u32, rows: vec2u, length: u32, is_square_root_free: bool) {
    let is_along_row = batch.down == 0;
    let first = select(rows.x / 4u * 2u * TILE_WIDTH, rows.x * (TILE_WIDTH / 2u), is_along_row);
    let end = select((rows.y + 3u) / 4u * 2u * TILE_WIDTH, rows.y * (TILE_WIDTH / 2u), is_along_row);
    let way = u32(batch.down * i32(TILE_WIDTH) + batch.right);
    for (var k = first + thread; k < end; k += WORKGROUP) {
        let stick = stick_of(k, batch, length);
        let a = stick.x;
        let b = a + way;
        if stick.y >= TILE_WIDTH || b >= TILE_WIDTH * TILE_HEIGHT {
            continue;
        }
        let p = places[a];
        let q = places[b];
        if min(p.w, q.w) < 0.0 {
            continue;
        }
        let pull = stick_pull(p, q, batch.rest_length, batch.stiffness, 0, is_square_root_free);
        places[a] = vec4f(p.xyz + pull * p.w, p.w);
        places[b] = vec4f(q.xyz - pull * q.w, q.w);
    }
}

fn load(origin: vec2i, thread: u32) {
    let first = bodies[dispatch.body].first_particle;
    let size = vec2i(i32(bodies[dispatch.body].columns), i32(bodies[dispatch.body].rows));
    for (var i = thread; i < TILE_WIDTH * TILE_HEIGHT; i += WORKGROUP) {
        let place = origin + vec2i(i32(i % TILE_WIDTH), i32(i / TILE_WIDTH));
        // Beside the grid there is no particle: no stick acts on a negative inverse mass.
        var here = vec4f(0.0, 0.0, 0.0, -1.0);
        if all(place >= vec2i(0)) && all(place < size) {
            here = positions[first + u32(place.y * size.x + place.x)];
        }
        places[i] = here;
    }
}

fn store_inner(origin: vec2i, thread: u32) {
    let body = bodies[dispatch.body];
    let size = vec2i(i32(body.columns), i32(body.rows));
    for (var i = thread; i < INNER.x * INNER.y; i += WORKGROUP) {
        let local = vec2i(i32(i % INNER.x + HALO), i32(i / INNER.x + HALO));
        let place = origin + local;
        if all(place < size) {
            let index = u32(place.y * size.x + place.x);
            let here = places[u32(local.y) * TILE_WIDTH + u32(local.x)];
            var position = here.xyz;
            if here.w > 0.0 {
                position = held_by_tethers(position, index, body);
            }
            next_positions[body.first_particle + index] = vec4f(position, here.w);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn project_grid(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let origin = vec2i(group.xy * INNER) - vec2i(i32(HALO));
    load(origin, thread);
    workgroupBarrier();
    let is_square_root_free = bodies[dispatch.body].is_square_root_free != 0u;
    let first_batch = bodies[dispatch.body].first_batch;
    let batch_count = bodies[dispatch.body].batch_count;
    // The farther the iteration, the fewer rows of the halo can still reach the inner part.
    var reach = HALO;
    for (var i = 0u; i < batch_count; i++) {
        let index = select(i, batch_count - 1u - i, dispatch.iteration % 2u == 1u);
        let batch = batches[first_batch + index];
        let rows = vec2u(HALO - reach, TILE_HEIGHT - HALO + reach);
        // Each length has code of its own, in which it is a constant.
        if select(batch.down, batch.right, batch.down == 0) == 1 {
            project_batch(batch, thread, rows, 1u, is_square_root_free);
        } else {
            project_batch(batch, thread, rows, 2u, is_square_root_free);
        }
        reach -= u32(batch.down);
        workgroupBarrier();
    }
    store_inner(origin, thread);
}
