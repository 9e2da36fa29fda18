//! The list of methods.

use super::feature::FeatureBased;
use super::method::Method;
use super::object_space::ObjectSpace;
use super::ours::Ours;
use super::sweep_and_prune::SweepAndPrune;
use super::uniform_grid::UniformGrid;

/// The methods, ours first.
pub fn all() -> Vec<Box<dyn Method>> {
    vec![
        Box::new(Ours::default()),
        Box::new(FeatureBased::default()),
        Box::new(UniformGrid::default()),
        Box::new(ObjectSpace::default()),
        Box::new(SweepAndPrune::default()),
    ]
}
