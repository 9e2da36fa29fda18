//! Spatial decomposition: a uniform grid over the cloth's faces.
//!
//! A step whose balls come near sorts the faces into cubes by counting, each into the cube of its box's centre, so that
//! none is listed twice (a *loose* grid: queries grow by half the largest box). The cubes are as wide as a ball's
//! radius or the longest face, whichever is more, at most 65,536 of them; twice and half of that were slower. In a
//! substep a ball visits the cubes around its current position, widened by the greatest motion of a particle since, and
//! queries each face whose box touches its own for the closest feature.

use drape_solver::glam::{UVec3, Vec3, Vec3A};

use super::closest_feature::ClosestFeatureQueries;
use super::method::{Contact, Method, Pair};
use super::state::State;

/// The greatest number of cubes: clearing more costs more than they save.
const MOST_CUBES: f32 = 65_536.0;

/// See the [module](self).
#[derive(Default)]
pub struct UniformGrid {
    low: Vec3,
    /// Cubes per metre.
    per_metre: f32,
    cubes: UVec3,
    /// The start of each cube's faces in `sorted`, from the second entry on; the last entry is their number.
    starts: Vec<u32>,
    /// Faces, cube by cube.
    sorted: Vec<u32>,
    cube_of_face: Vec<u32>,
    /// The growth of queries in metres: half the largest box, and the motion of a step.
    margin: Vec3,
    near: Vec<u32>,
    queries: ClosestFeatureQueries,
}

impl UniformGrid {
    fn cube(&self, point: Vec3) -> UVec3 {
        let cube = ((point - self.low) * self.per_metre).max(Vec3::ZERO).as_uvec3();
        cube.min(self.cubes - 1)
    }

    fn number(&self, cube: UVec3) -> usize {
        ((cube.z * self.cubes.y + cube.y) * self.cubes.x + cube.x) as usize
    }

    fn build(&mut self, state: &State, width: f32) {
        let [low, high] = state.bounds;
        let size = high - low;
        let mut width = width;
        let count = |width: f32| (size / width).floor() + 1.0;
        while count(width).element_product() > MOST_CUBES {
            width *= 1.25;
        }
        (self.low, self.per_metre, self.cubes) = (low, 1.0 / width, count(width).as_uvec3());
        self.starts.clear();
        self.starts.resize(self.cubes.element_product() as usize + 2, 0);
        self.cube_of_face.clear();
        let mut half = Vec3A::ZERO;
        for face in 0..state.faces.len() as u32 {
            let [a, b, c] = state.corners(face);
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            half = half.max(most - least);
            let cube = self.number(self.cube(Vec3::from((least + most) * 0.5)));
            self.cube_of_face.push(cube as u32);
            self.starts[cube + 1] += 1;
        }
        self.margin = Vec3::from(half * 0.5 + state.motion);
        let mut sum = 0;
        for end in &mut self.starts {
            sum += *end;
            *end = sum;
        }
        self.sorted.resize(self.cube_of_face.len(), 0);
        // Each entry is the end of a cube's faces. Filling from the back makes it their start.
        for (face, &cube) in self.cube_of_face.iter().enumerate().rev() {
            let place = &mut self.starts[cube as usize + 1];
            *place -= 1;
            self.sorted[*place as usize] = face as u32;
        }
    }
}

impl Method for UniformGrid {
    fn name(&self) -> &'static str {
        "spatial decomposition"
    }

    fn begin_step(&mut self, state: &mut State) {
        self.near.clear();
        self.near.extend(state.near_balls().map(|(ball, _)| ball));
        let radii = self.near.iter().map(|&ball| state.balls[ball as usize].apart);
        let widest = radii.fold(0.0, f32::max);
        if !self.near.is_empty() {
            self.build(state, widest.max(longest_side(state)));
        }
    }

    fn find(&mut self, state: &mut State) -> usize {
        let mut queries = core::mem::take(&mut self.queries);
        queries.clear();
        for &ball in &self.near {
            let sphere = &state.balls[ball as usize];
            let reach = self.margin + sphere.apart;
            let (low, high) = (self.cube(sphere.centre - reach), self.cube(sphere.centre + reach));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    let [start, end] = [low.x, high.x + 1].map(|x| self.number(UVec3::new(x, y, z)) + 1);
                    let row = self.starts[start] as usize..self.starts[end] as usize;
                    for &face in &self.sorted[row] {
                        queries.query(state, ball, sphere, face);
                    }
                }
            }
        }
        self.queries = queries;
        self.queries.count
    }

    fn pairs(&self, _: &State) -> Vec<Pair> {
        self.queries.contacts.iter().map(|contact: &Contact| contact.pair).collect()
    }
}

/// The longest side of the first face, as all are alike at rest.
fn longest_side(state: &State) -> f32 {
    let [a, b, c] = state.corners(0);
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}
