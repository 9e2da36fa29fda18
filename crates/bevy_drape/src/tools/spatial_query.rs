//! Queries for bodies by place: ray casts, sphere casts, nearest points, overlaps. For bullets, cameras and characters.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::gestures::Gestures;
//! use bevy_drape::spatial_query::{DrapeQueryFilter, DrapeSpatialQuery};
//!
//! /// A bullet along -Z leaves a hole of 5 cm in each cloth on its way of 50 m.
//! fn shoot(bodies: DrapeSpatialQuery, mut commands: Commands) {
//!     let ray = Ray3d::new(Vec3::new(0.0, 1.0, 5.0), Dir3::NEG_Z);
//!     for (body, hit) in bodies.ray_hits(ray, 50.0, &DrapeQueryFilter::default()) {
//!         println!("{body} is hit {} m away, near particle {}", hit.distance, hit.particle);
//!         commands.pierce(hit.position, ray.direction, 0.05);
//!     }
//! }
//!
//! /// A camera of 20 cm stays on this side of all cloth but the cape of its character.
//! fn follow(bodies: DrapeSpatialQuery, cape: Single<Entity, With<Cloth>>, mut camera: Single<&mut Transform>) {
//!     let (path, length) = (Ray3d::new(Vec3::Y * 1.7, Dir3::Z), 4.0);
//!     let all_but_cape = DrapeQueryFilter::from_excluded_entities([*cape]);
//!     let hit = bodies.cast_sphere(path, 0.2, length, &all_but_cape);
//!     camera.translation = path.get_point(hit.map_or(length, |(_, hit)| hit.distance));
//! }
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, DrapePlugins::default()));
//! # app.world_mut().spawn(Cloth::new(1.0, 1.0));
//! # app.add_systems(Update, (shoot, follow)).update();
//! ```

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks};
use crate::tools::body_hit::BodyHit;
use crate::tools::point_projection::project_point;
pub use crate::tools::query_filter::DrapeQueryFilter;
use crate::tools::ray_cast::{cast_ray, meets_box};
use crate::tools::sphere_cast::cast_sphere;

/// Finds cloth, ropes and soft bodies by place, as a physics engine's spatial query finds colliders; see the
/// [module](self).
///
/// Faces are thin, seen from both sides, and hollow: nothing is inside of a closed body. Bodies without faces are links
/// with the radius of their [thickness](crate::body::BodySurface::thickness). Soft bodies answer with the surface of
/// their cells, not with their mesh. Balls and obstacles are no bodies.
///
/// Bodies are found where the last step, or an edit since, has left them, asleep or not, with or without a mesh. Meshes
/// are drawn up to a step behind. Bodies that are [culled](Activity::Culled) or disabled are not found. Ask outside the
/// step: within it bodies may have left the boxes of the step before. A query costs a test of the box of each body, and
/// of each face of a body whose box it meets.
///
/// Of several bodies at the same distance the oldest comes first. A distance or radius that is negative or NaN, or a
/// place that is not finite, finds nothing; an infinite distance is no limit.
#[derive(SystemParam)]
pub struct DrapeSpatialQuery<'w, 's> {
    bodies: Query<
        'w,
        's,
        (
            Entity,
            &'static Particles,
            &'static Sticks,
            &'static BodyState,
            &'static Activity,
            Option<&'static DrapeLayers>,
        ),
    >,
}

/// A body that may be found.
struct Candidate<'a> {
    entity: Entity,
    particles: &'a Particles,
    sticks: &'a Sticks,
    state: &'a BodyState,
}

impl DrapeSpatialQuery<'_, '_> {
    /// Returns the first hit of `ray` within `max_distance` metres, as [`cast_ray`] returns it for one body. A ray that
    /// starts inside a link does not hit that link.
    pub fn cast_ray(
        &self,
        ray: Ray3d,
        max_distance: f32,
        filter: &DrapeQueryFilter,
    ) -> Option<(Entity, BodyHit)> {
        self.first(max_distance, filter, |body, reach| body.cast_ray(ray, reach))
    }

    /// Returns the first hit of `ray` on each body within `max_distance` metres, nearest first.
    pub fn ray_hits(
        &self,
        ray: Ray3d,
        max_distance: f32,
        filter: &DrapeQueryFilter,
    ) -> Vec<(Entity, BodyHit)> {
        let hits = self.candidates(filter).filter_map(|body| Some((body.cast_ray(ray, max_distance)?, body)));
        let mut hits: Vec<_> = hits.collect();
        hits.sort_by(|(hit, body), (other, other_body)| {
            hit.distance.total_cmp(&other.distance).then(body.state.order.cmp(&other_body.state.order))
        });
        hits.into_iter().map(|(hit, body)| (body.entity, hit)).collect()
    }

    /// Returns where a sphere of `radius` metres, whose centre moves along `path`, first touches a body within `max_distance`
    /// metres. The distance is that of its centre, the position that of the touch. A sphere that touches a body where it
    /// starts has a distance of 0, and the position of the nearest point.
    pub fn cast_sphere(
        &self,
        path: Ray3d,
        radius: f32,
        max_distance: f32,
        filter: &DrapeQueryFilter,
    ) -> Option<(Entity, BodyHit)> {
        self.first(max_distance, filter, |body, reach| body.cast_sphere(path, radius, reach))
    }

    /// Returns the point of a body that is nearest to `point`, within `max_distance` metres. A point inside a link has a
    /// distance of 0 and is its own nearest.
    pub fn project_point(
        &self,
        point: Vec3,
        max_distance: f32,
        filter: &DrapeQueryFilter,
    ) -> Option<(Entity, BodyHit)> {
        self.first(max_distance, filter, |body, reach| body.project_point(point, reach))
    }

    /// Returns the bodies that a sphere of `radius` metres touches, oldest first.
    pub fn sphere_intersections(&self, centre: Vec3, radius: f32, filter: &DrapeQueryFilter) -> Vec<Entity> {
        let touched = self.candidates(filter).filter(|body| body.project_point(centre, radius).is_some());
        let mut touched: Vec<_> = touched.map(|body| (body.state.order, body.entity)).collect();
        touched.sort_by_key(|&(order, _)| order);
        touched.into_iter().map(|(_, entity)| entity).collect()
    }

    /// Returns the hit of least distance of those that `hit` finds on a body within a distance.
    fn first(
        &self,
        max_distance: f32,
        filter: &DrapeQueryFilter,
        hit: impl Fn(&Candidate, f32) -> Option<BodyHit>,
    ) -> Option<(Entity, BodyHit)> {
        let mut first: Option<(BodyHit, Candidate)> = None;
        for body in self.candidates(filter) {
            let reach = first.as_ref().map_or(max_distance, |(hit, _)| hit.distance);
            let Some(hit) = hit(&body, reach) else { continue };
            if first.as_ref().is_none_or(|(other, other_body)| {
                hit.distance < other.distance || body.state.order < other_body.state.order
            }) {
                first = Some((hit, body));
            }
        }
        first.map(|(hit, body)| (body.entity, hit))
    }

    /// The bodies that the filter lets through.
    fn candidates(&self, filter: &DrapeQueryFilter) -> impl Iterator<Item = Candidate<'_>> {
        self.bodies.iter().filter_map(|(entity, particles, sticks, state, &activity, layers)| {
            let layers = layers.copied().unwrap_or_default();
            let is_there = activity != Activity::Culled && sticks.fit(particles);
            (is_there && filter.admits(entity, layers)).then_some(Candidate {
                entity,
                particles,
                sticks,
                state,
            })
        })
    }
}

impl Candidate<'_> {
    /// Box around the surface of the body as it is now.
    fn bounds(&self) -> Bounds {
        let Self { particles, sticks, state, .. } = *self;
        state.extent_now(particles, sticks).surface(&state.settings)
    }

    fn cast_ray(&self, ray: Ray3d, max_distance: f32) -> Option<BodyHit> {
        let Self { particles, sticks, state, .. } = *self;
        let may_hit = meets_box(ray, max_distance, self.bounds());
        may_hit.then(|| cast_ray(ray, max_distance, particles, sticks, state.settings.thickness))?
    }

    fn cast_sphere(&self, path: Ray3d, radius: f32, max_distance: f32) -> Option<BodyHit> {
        let Self { particles, sticks, state, .. } = *self;
        let may_hit = meets_box(path, max_distance, self.bounds().grown(radius));
        if !may_hit || max_distance < 0.0 {
            return None;
        }
        match self.project_point(path.origin, radius) {
            Some(nearest) => Some(BodyHit { distance: 0.0, ..nearest }),
            None => cast_sphere(path, radius, max_distance, particles, sticks, state.settings.thickness),
        }
    }

    fn project_point(&self, point: Vec3, max_distance: f32) -> Option<BodyHit> {
        let Self { particles, sticks, state, .. } = *self;
        let may_hit = self.bounds().distance_to(point) <= max_distance;
        may_hit.then(|| project_point(point, max_distance, particles, sticks, state.settings.thickness))?
    }
}
