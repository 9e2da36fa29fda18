//! Three columns of numbers, one vector per particle.

use glam::Vec3;

/// Vectors stored as three columns (x, y, z), so that loops over all particles vectorise.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Columns {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Columns {
    pub fn len(&self) -> usize {
        self.x.len()
    }

    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    pub fn set(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    pub fn add(&mut self, i: usize, v: Vec3) {
        self.x[i] += v.x;
        self.y[i] += v.y;
        self.z[i] += v.z;
    }

    pub fn clear(&mut self) {
        for column in self.each_mut() {
            column.clear();
        }
    }

    /// Makes room for `len` zero vectors, reusing what is allocated.
    pub fn reset(&mut self, len: usize) {
        for column in self.each_mut() {
            column.clear();
            column.resize(len, 0.0);
        }
    }

    pub fn push(&mut self, v: Vec3) {
        self.x.push(v.x);
        self.y.push(v.y);
        self.z.push(v.z);
    }

    pub fn each(&self) -> [&Vec<f32>; 3] {
        [&self.x, &self.y, &self.z]
    }

    pub fn each_mut(&mut self) -> [&mut Vec<f32>; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        (0..self.len()).map(|i| self.get(i))
    }
}
