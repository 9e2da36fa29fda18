//! Registers levels of detail.

use bevy::prelude::*;

use crate::detail::change::{LostDetail, choose_detail, note_lost_detail};
use crate::detail::level::{CurrentDetail, LevelOfDetail};
use crate::refusal::forget_removed;
use crate::schedule::{DrapeSchedule, ScenePhase};

/// Less work for distant bodies.
pub(crate) struct LevelOfDetailPlugin;

impl Plugin for LevelOfDetailPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(LevelOfDetail, CurrentDetail)>()
            .init_resource::<LostDetail>()
            .add_observer(note_lost_detail)
            .add_observer(forget_removed::<LevelOfDetail>)
            .add_systems(DrapeSchedule, choose_detail.in_set(ScenePhase::ChooseDetail));
    }
}
