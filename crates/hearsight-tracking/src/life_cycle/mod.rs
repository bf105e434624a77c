//! The life cycle of tracks: association, birth, existence, exclusion, death and re-entry, one file each.

mod association;
mod birth;
mod encounter;
mod exclusion;
mod existence;
mod re_entry;

pub use association::{Association, AssociationSettings};
pub use birth::BirthSettings;
pub use encounter::{Encounter, EncounterSettings};
pub use exclusion::ExclusionSettings;
pub use existence::ExistenceSettings;
pub use re_entry::{Likeness, Memory, ReEntrySettings};

pub(crate) use birth::{is_clear_of_edges, may_begin, may_publish, surroundings};
pub(crate) use encounter::{meet, settle};
pub(crate) use exclusion::{bodies, body_part_rate, covers, is_nearer, same_place, weaker};
pub(crate) use existence::{Situation, log_ratio};
