//! Invalid input: logged once and left out of the simulation.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::drape_solver::BuildError;
//!
//! fn report(refusals: Res<Refusals>) {
//!     // Empty as long as everything that was spawned can be simulated.
//!     for refusal in refusals.iter() {
//!         let is_out_of_range = matches!(refusal.error().downcast_ref(), Some(BuildError::OutOfRange { .. }));
//!         println!("{:?}, {}: {is_out_of_range}", refusal.entity, refusal.component);
//!     }
//! }
//! # App::new().init_resource::<Refusals>().add_systems(Update, report).update();
//! ```

use core::error::Error;
use core::fmt;
use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;

/// An error of any type.
pub(crate) type Cause = Box<dyn Error + Send + Sync>;

/// A component of an entity, or a resource, that cannot be used.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// The entity; none for a resource.
    pub entity: Option<Entity>,
    /// The component, or resource.
    pub component: &'static str,
    error: Arc<dyn Error + Send + Sync>,
    is_logged: bool,
}

impl Refusal {
    /// The error. Errors of the solver and of meshes keep their types:
    /// [`BuildError`](drape_solver::BuildError), `MeshFault` (as the [source](Error::source) of one that names the mesh),
    /// [`DetailError`](crate::detail::DetailError). Others are words.
    pub fn error(&self) -> &(dyn Error + Send + Sync + 'static) {
        &*self.error
    }

    /// The refusal in a sentence, with the name of the entity if it has one.
    fn told(&self, name: Option<&Name>) -> String {
        let Self { entity, component, error, .. } = self;
        match (entity, name) {
            (Some(entity), Some(name)) => {
                format!("{component} of “{name}”, entity {entity}, is left out of the simulation: {error}")
            }
            (Some(entity), None) => {
                format!("{component} of entity {entity} is left out of the simulation: {error}")
            }
            (None, _) => format!("resource {component} cannot be used: {error}"),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.told(None))
    }
}

/// Everything that is left out of the simulation, and why. Each fault is logged once as an error, not sixty times a
/// second, with the [`Name`] of the entity.
#[derive(Resource, Reflect, Clone, Debug, Default)]
#[reflect(opaque)]
#[reflect(Resource, Default, Debug, Clone)]
pub struct Refusals {
    refused: BTreeMap<(Option<Entity>, &'static str), Refusal>,
    /// True if something was refused that is not logged yet.
    has_news: bool,
}

impl Refusals {
    /// All refusals, by entity. A refusal is forgotten when its component is mended or removed.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Refusal> {
        self.refused.values()
    }

    /// The refusals of `entity`.
    pub fn of(&self, entity: Entity) -> impl Iterator<Item = &Refusal> {
        self.iter().filter(move |refusal| refusal.entity == Some(entity))
    }

    /// True if everything can be simulated.
    pub fn is_empty(&self) -> bool {
        self.refused.is_empty()
    }

    /// Notes that a component of `entity` cannot be used.
    pub(crate) fn entity(&mut self, entity: Entity, component: &'static str, error: impl Into<Cause>) {
        self.note(Some(entity), component, error.into());
    }

    /// Notes that a resource cannot be used.
    pub(crate) fn resource(&mut self, resource: &'static str, error: impl Into<Cause>) {
        self.note(None, resource, error.into());
    }

    /// Forgets the refusals of `entity`, after it was despawned or mended.
    pub(crate) fn forget(&mut self, entity: Entity) {
        self.refused.retain(|(about, _), _| *about != Some(entity));
    }

    /// Forgets the refusal of a component of `entity`, after it was changed.
    pub(crate) fn forget_component(&mut self, entity: Entity, component: &'static str) {
        self.refused.remove(&(Some(entity), component));
    }

    /// Forgets the refusals of entities' components for which `is_mended` holds.
    pub(crate) fn forget_if(&mut self, is_mended: impl Fn(Entity, &str) -> bool) {
        self.refused
            .retain(|&(about, component), _| !about.is_some_and(|entity| is_mended(entity, component)));
    }

    /// Forgets the refusal of a resource, after it was mended.
    pub(crate) fn forget_resource(&mut self, resource: &'static str) {
        self.refused.remove(&(None, resource));
    }

    fn note(&mut self, entity: Option<Entity>, component: &'static str, error: Cause) {
        let known = self.refused.get(&(entity, component));
        if known.is_none_or(|known| known.error.to_string() != error.to_string()) {
            self.refused.insert(
                (entity, component),
                Refusal { entity, component, error: error.into(), is_logged: false },
            );
            self.has_news = true;
        }
    }
}

/// Logs what was refused since this last ran.
pub(crate) fn log_refusals(mut refusals: ResMut<Refusals>, names: Query<&Name>) {
    if !refusals.has_news {
        return;
    }
    refusals.has_news = false;
    for refusal in refusals.refused.values_mut().filter(|refusal| !refusal.is_logged) {
        refusal.is_logged = true;
        error!("{}", refusal.told(refusal.entity.and_then(|entity| names.get(entity).ok())));
    }
}

/// Forgets the refusals of an entity that loses its `C`.
pub(crate) fn forget_removed<C: Component>(removed: On<Remove<C>>, mut refusals: ResMut<Refusals>) {
    refusals.forget(removed.entity);
}
